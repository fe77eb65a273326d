#include "plugin/identification/sensitivity/landmarks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::sensitivity {

namespace {

using experiment::Readings;
using experiment::Run;
using replay::Landmark;

constexpr double kContactShare = 0.02; ///< of the largest force

std::size_t firstAfter(const std::vector<double>& time, double t) {
    return static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
}

/// Speed of the drive at a time, m/s.
double speedAt(const Run& run, double t) {
    for (std::size_t i = 1; i < run.driveTime.size(); ++i)
        if (t <= run.driveTime[i])
            return (run.driveDisplacement[i] - run.driveDisplacement[i - 1]) /
                   (run.driveTime[i] - run.driveTime[i - 1]);
    return 0.0;
}

/// Refines a jump between two samples by the trace: time at half height, and the force before it.
void refine(Landmark& jump, const Readings& samples, const Readings& trace) {
    const std::size_t row = firstAfter(samples.time, jump.time);
    if (row == 0 || row >= samples.time.size())
        return;
    const double from = samples.time[row >= 2 ? row - 2 : 0];
    const double to = samples.time[std::min(row + 1, samples.time.size() - 1)];
    const bool falls = jump.after < jump.before;
    const double half = 0.5 * (jump.before + jump.after);
    double ahead = jump.before;
    for (std::size_t i = firstAfter(trace.time, from); i < trace.time.size() && trace.time[i] <= to; ++i) {
        const double f = trace.force[i];
        if (i == 0 || (falls ? f > half : f < half)) {
            ahead = falls ? std::max(ahead, f) : std::min(ahead, f);
            continue;
        }
        const double before = trace.force[i - 1];
        if (falls ? before <= half : before >= half)
            continue; // the interval begins on the far side
        const double share = before == f ? 0.0 : (before - half) / (before - f);
        jump.time = trace.time[i - 1] + share * (trace.time[i] - trace.time[i - 1]);
        jump.displacement = trace.displacement[i - 1] + share * (trace.displacement[i] - trace.displacement[i - 1]);
        jump.before = ahead;
        return;
    }
}

std::vector<Landmark> jumpsOf(const Readings& readings, const Readings* trace) {
    std::vector<Landmark> jumps = replay::findLandmarks(readings);
    if (trace != nullptr)
        for (Landmark& jump : jumps)
            refine(jump, readings, *trace);
    return jumps;
}

void add(Landmarks& l, const std::string& name, const char* unit, double value, double samplingError = 0.0) {
    l.names.push_back(name);
    l.units.emplace_back(unit);
    l.values.push_back(value);
    l.samplingError.push_back(samplingError);
}

/// Landmarks of one jump; NaN without one.
void addJump(Landmarks& l, std::size_t number, const Landmark* jump, double samplingError) {
    const std::string name = "jump" + std::to_string(number + 1);
    add(l, name + "_displacement", "m", jump != nullptr ? jump->displacement : kNone, samplingError);
    add(l, name + "_before", "N", jump != nullptr ? jump->before : kNone);
    add(l, name + "_after", "N", jump != nullptr ? jump->after : kNone);
    add(l, name + "_drop", "N", jump != nullptr ? jump->before - jump->after : kNone);
}

double samplingErrorOf(const Run& run, const Landmark& jump, bool exact) {
    return exact || run.samplingRate <= 0.0 ? 0.0 : 0.5 * std::abs(speedAt(run, jump.time)) / run.samplingRate;
}

/// Displacement at which |force| crosses `level` between rows i and i + 1.
double crossing(const Readings& r, std::size_t i, double level) {
    const double a = std::abs(r.force[i]) - level, b = std::abs(r.force[i + 1]) - level;
    const double share = a == b ? 0.0 : std::clamp(a / (a - b), 0.0, 1.0);
    return r.displacement[i] + share * (r.displacement[i + 1] - r.displacement[i]);
}

/// Vertex of the parabola through row i and its neighbours.
double vertex(const Readings& r, std::size_t i) {
    if (i == 0 || i + 1 >= r.force.size())
        return r.displacement[i];
    const double left = r.displacement[i] - r.displacement[i - 1], right = r.displacement[i + 1] - r.displacement[i];
    const double down = r.force[i] - r.force[i - 1], up = r.force[i + 1] - r.force[i];
    const double bend = up / right - down / left;
    if (!(left * right > 0.0) || !std::isfinite(bend) || bend == 0.0)
        return r.displacement[i];
    const double shift = -0.5 * (up / right * left + down / left * right) / bend;
    const double most = 0.5 * std::max(std::abs(left), std::abs(right));
    return r.displacement[i] + std::clamp(shift, -most, most);
}

void addExtremes(Landmarks& l, const Run& run, const Readings& r) {
    double most = -std::numeric_limits<double>::infinity(), least = -most;
    std::size_t at = 0;
    for (std::size_t i = 0; i < r.force.size(); ++i) {
        if (!std::isfinite(r.force[i]))
            continue;
        least = std::min(least, r.force[i]);
        if (r.force[i] > most) {
            most = r.force[i];
            at = i;
        }
    }
    const bool any = std::isfinite(most);
    const double samplingError =
        any && run.samplingRate > 0.0 ? 0.5 * std::abs(speedAt(run, r.time[at])) / run.samplingRate : 0.0;
    add(l, "peak_force", "N", any ? most : kNone);
    add(l, "peak_displacement", "m", any ? vertex(r, at) : kNone, samplingError);
    add(l, "min_force", "N", any ? least : kNone);

    const double level = any ? kContactShare * std::max(std::abs(most), std::abs(least)) : kNone;
    double touch = kNone, release = kNone;
    for (std::size_t i = 0; i + 1 < r.force.size(); ++i) {
        const bool here = std::abs(r.force[i]) > level, next = std::abs(r.force[i + 1]) > level;
        if (!std::isfinite(r.force[i]) || !std::isfinite(r.force[i + 1]) || here == next)
            continue;
        if (next && std::isnan(touch))
            touch = crossing(r, i, level);
        if (here)
            release = crossing(r, i, level);
    }
    add(l, "first_contact_displacement", "m", touch);
    add(l, "release_displacement", "m", release);
    add(l, "residual_displacement", "m", release - touch);
}

void addWork(Landmarks& l, const Run& run, const Readings& r) {
    double all = 0.0;
    std::size_t number = 0;
    for (std::size_t leg = 1; leg < run.driveTime.size(); ++leg) {
        if (run.driveDisplacement[leg] == run.driveDisplacement[leg - 1])
            continue;
        const double slack = 1e-9 * (run.driveTime.back() - run.driveTime.front());
        double work = 0.0;
        for (std::size_t i = 0; i + 1 < r.time.size(); ++i) {
            const double middle = 0.5 * (r.time[i] + r.time[i + 1]);
            const double way = r.displacement[i + 1] - r.displacement[i], force = 0.5 * (r.force[i] + r.force[i + 1]);
            if (middle >= run.driveTime[leg - 1] - slack && middle < run.driveTime[leg] - slack &&
                std::isfinite(force * way))
                work += force * way;
        }
        all += work;
        add(l, "segment" + std::to_string(++number) + "_work", "J", work);
    }
    add(l, "loop_area", "J", all);
}

/// Landmarks other than jumps. They use samples only, so both kinds of curve are measured alike.
void addRest(Landmarks& l, const Run& run, const Readings& readings) {
    addExtremes(l, run, readings);
    addWork(l, run, readings);
}

} // namespace

Landmarks measure(const Run& run, const Readings& readings, const Readings* trace) {
    Landmarks l;
    l.jumps = jumpsOf(readings, trace);
    for (std::size_t i = 0; i < l.jumps.size(); ++i)
        addJump(l, i, &l.jumps[i], samplingErrorOf(run, l.jumps[i], trace != nullptr));
    addRest(l, run, readings);
    return l;
}

Landmarks measureLike(const Landmarks& reference, const Run& run, const Readings& readings, const Readings* trace,
                      double farthest) {
    Landmarks l;
    l.jumps = jumpsOf(readings, trace);
    const std::vector<std::pair<std::size_t, std::size_t>> pairs =
        replay::matchLandmarks(reference.jumps, l.jumps, farthest);
    for (std::size_t i = 0; i < reference.jumps.size(); ++i) {
        const auto pair = std::find_if(pairs.begin(), pairs.end(), [i](const auto& p) { return p.first == i; });
        const Landmark* jump = pair == pairs.end() ? nullptr : &l.jumps[pair->second];
        addJump(l, i, jump, jump == nullptr ? 0.0 : samplingErrorOf(run, *jump, trace != nullptr));
    }
    addRest(l, run, readings);
    return l;
}

} // namespace supercircle::sensitivity
