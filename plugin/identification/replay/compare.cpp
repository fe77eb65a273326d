#include "plugin/identification/replay/compare.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::replay {

namespace {

using experiment::Readings;
using experiment::Run;

struct Interval {
    double from = 0.0, to = 0.0; ///< s
};

double peak(const std::vector<double>& force) {
    double most = 0.0;
    for (const double f : force)
        if (std::isfinite(f))
            most = std::max(most, std::abs(f));
    return most;
}

/// Where the force crosses the middle between rows i and j.
Landmark halfway(const Readings& r, std::size_t i, std::size_t j) {
    Landmark mark{r.time[j], r.displacement[j], r.force[i], r.force[j]};
    const double half = 0.5 * (mark.before + mark.after);
    for (std::size_t k = i; k < j; ++k) {
        const double a = r.force[k] - half, b = r.force[k + 1] - half;
        if (a * b > 0.0 || a == b)
            continue;
        const double share = a / (a - b);
        mark.time = r.time[k] + share * (r.time[k + 1] - r.time[k]);
        mark.displacement = r.displacement[k] + share * (r.displacement[k + 1] - r.displacement[k]);
        break;
    }
    return mark;
}

std::vector<Interval> windows(const Comparison& c, const ExclusionWindow& w) {
    std::vector<Interval> all;
    std::vector<char> usedA(c.recorded.size(), 0), usedB(c.simulated.size(), 0);
    for (const auto& [i, j] : c.matches) {
        const double a = c.recorded[i].time, b = c.simulated[j].time;
        all.push_back({std::min(a, b) - w.before, std::max(a, b) + w.after});
        usedA[i] = usedB[j] = 1;
    }
    for (std::size_t i = 0; i < usedA.size(); ++i)
        if (!usedA[i])
            all.push_back({c.recorded[i].time - w.before, c.recorded[i].time + w.after});
    for (std::size_t j = 0; j < usedB.size(); ++j)
        if (!usedB[j])
            all.push_back({c.simulated[j].time - w.before, c.simulated[j].time + w.after});
    return all;
}

bool inside(const std::vector<Interval>& all, double t) {
    return std::any_of(all.begin(), all.end(), [t](const Interval& i) { return t >= i.from && t <= i.to; });
}

void compareForces(const Run& run, const Readings& simulated, const std::vector<Interval>& windowed, Comparison& c) {
    const std::size_t rows = run.readings.time.size();
    c.residual.assign(rows, std::numeric_limits<double>::quiet_NaN());
    c.excluded.assign(rows, false);
    double all = 0.0, outside = 0.0, mean = 0.0;
    std::size_t countAll = 0, countOutside = 0, left = 0;
    for (std::size_t k = 0; k < rows; ++k) {
        c.excluded[k] = inside(windowed, run.readings.time[k]);
        left += c.excluded[k] ? 1U : 0U;
        if (k >= simulated.force.size() || !std::isfinite(run.readings.force[k]))
            continue;
        const double e = c.residual[k] = simulated.force[k] - run.readings.force[k];
        all += e * e;
        ++countAll;
        if (c.excluded[k])
            continue;
        outside += e * e;
        mean += e;
        ++countOutside;
        if (std::abs(e) > c.maxError) {
            c.maxError = std::abs(e);
            c.maxErrorAt = run.readings.time[k];
        }
    }
    c.rmseAll = countAll > 0 ? std::sqrt(all / static_cast<double>(countAll)) : 0.0;
    c.rmse = countOutside > 0 ? std::sqrt(outside / static_cast<double>(countOutside)) : 0.0;
    c.residualMean = countOutside > 0 ? mean / static_cast<double>(countOutside) : 0.0;
    c.rmseAboutMean = std::sqrt(std::max(0.0, c.rmse * c.rmse - c.residualMean * c.residualMean));
    c.excludedFraction = rows > 0 ? static_cast<double>(left) / static_cast<double>(rows) : 0.0;
}

void compareMarkers(const Run& run, const Simulated& simulated, const std::vector<Interval>& windowed, Comparison& c) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t m = 0; m < run.markers.x.size() && m < simulated.markers.x.size(); ++m)
        for (std::size_t k = 0; k < run.markers.time.size() && k < simulated.markers.time.size(); ++k) {
            const double d = math::hypot(simulated.markers.x[m][k] - run.markers.x[m][k],
                                         simulated.markers.y[m][k] - run.markers.y[m][k]);
            if (!std::isfinite(d) || inside(windowed, run.markers.time[k]))
                continue;
            sum += d * d;
            ++count;
            c.markerMax = std::max(c.markerMax, d);
        }
    c.markerRmse = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

void compareFurther(const Run& run, const Readings& simulated, Comparison& c) {
    for (std::size_t i = 0; i < run.readings.further.size(); ++i) {
        const std::vector<double>& recorded = run.readings.further[i];
        const std::vector<double> none, &there = i < simulated.further.size() ? simulated.further[i] : none;
        ChannelComparison out;
        out.peakRecorded = peak(recorded);
        out.peakSimulated = peak(there);
        out.residual.assign(recorded.size(), std::numeric_limits<double>::quiet_NaN());
        double sum = 0.0, count = 0.0;
        for (std::size_t k = 0; k < recorded.size() && k < there.size(); ++k) {
            const double e = out.residual[k] = there[k] - recorded[k];
            if (!std::isfinite(e) || c.excluded[k])
                continue;
            sum += e * e;
            count += 1.0;
            if (std::abs(e) > out.maxError) {
                out.maxError = std::abs(e);
                out.maxErrorAt = run.readings.time[k];
            }
        }
        out.rmse = count > 0.0 ? std::sqrt(sum / count) : 0.0;
        c.further.push_back(std::move(out));
    }
}

} // namespace

std::vector<Landmark> findLandmarks(const Readings& r, double share) {
    std::vector<Landmark> found;
    const std::size_t n = r.force.size();
    if (n < 7)
        return found;
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const double f : r.force)
        if (std::isfinite(f)) {
            lo = std::min(lo, f);
            hi = std::max(hi, f);
        }
    const auto jump = [&](std::size_t i) { return r.force[i + 2] - r.force[i]; };
    for (std::size_t i = 2; i + 4 < n; ++i) {
        const double here = std::abs(jump(i));
        const bool largest = here >= std::abs(jump(i - 1)) && here > std::abs(jump(i + 1));
        // Largest change on the quieter side of the jump.
        const double around = std::min(std::abs(jump(i - 2)), std::abs(jump(i + 2)));
        if (!(here >= share * (hi - lo)) || !largest || here < 3.0 * around)
            continue;
        found.push_back(halfway(r, i, i + 2));
    }
    return found;
}

std::vector<double> jumpTimes(const Simulated& simulated) {
    std::vector<double> times;
    const Readings& r = simulated.readings;
    const Readings& fine = simulated.trace;
    const double dt =
        r.time.size() > 1 ? (r.time.back() - r.time.front()) / static_cast<double>(r.time.size() - 1) : 0.0;
    for (const Landmark& mark : findLandmarks(r)) {
        const double half = 0.5 * (mark.before + mark.after);
        double nearest = dt, time = mark.time;
        for (std::size_t k = 1; k < fine.time.size(); ++k) {
            const double a = fine.force[k - 1] - half, b = fine.force[k] - half;
            if (a == b || a * b > 0.0 || (b > a) != (mark.after > mark.before))
                continue;
            const double at = fine.time[k - 1] + a / (a - b) * (fine.time[k] - fine.time[k - 1]);
            if (std::abs(at - mark.time) < nearest) {
                nearest = std::abs(at - mark.time);
                time = at;
            }
        }
        times.push_back(time);
    }
    return times;
}

std::vector<std::pair<std::size_t, std::size_t>> matchLandmarks(const std::vector<Landmark>& a,
                                                                const std::vector<Landmark>& b, double farthest) {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    std::vector<char> usedA(a.size(), 0), usedB(b.size(), 0);
    for (;;) {
        double best = farthest;
        std::pair<std::size_t, std::size_t> next;
        bool found = false;
        for (std::size_t i = 0; i < a.size(); ++i)
            for (std::size_t j = 0; j < b.size(); ++j) {
                const double apart = std::abs(a[i].time - b[j].time);
                const bool alike = (a[i].after > a[i].before) == (b[j].after > b[j].before);
                if (!usedA[i] && !usedB[j] && alike && apart <= best) {
                    best = apart;
                    next = {i, j};
                    found = true;
                }
            }
        if (!found)
            break;
        usedA[next.first] = usedB[next.second] = 1;
        pairs.push_back(next);
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

Comparison compare(const Run& run, const Simulated& simulated, const ExclusionWindow& window, bool jumps) {
    Comparison c;
    c.peakRecorded = peak(run.readings.force);
    c.peakSimulated = peak(simulated.readings.force);
    if (jumps) {
        c.recorded = findLandmarks(run.readings);
        c.simulated = findLandmarks(simulated.readings);
    }
    c.matches = matchLandmarks(c.recorded, c.simulated, window.farthest);
    const std::vector<Interval> windowed = windows(c, window);
    compareForces(run, simulated.readings, windowed, c);
    compareFurther(run, simulated.readings, c);
    compareMarkers(run, simulated, windowed, c);
    return c;
}

} // namespace supercircle::replay
