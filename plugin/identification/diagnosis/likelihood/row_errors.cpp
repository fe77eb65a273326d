#include "plugin/identification/diagnosis/likelihood/row_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

constexpr double kMissing = std::numeric_limits<double>::infinity();

std::vector<double> listOf(const Eigen::VectorXd& v) {
    return {v.data(), v.data() + v.size()};
}

/// Steepest change of the simulated force from one row to the next within two rows, N.
double steepest(const Eigen::VectorXd& force, Eigen::Index k) {
    double most = 0.0;
    for (Eigen::Index j = std::max<Eigen::Index>(1, k - 1); j <= std::min(force.size() - 1, k + 2); ++j)
        most = std::max(most, std::abs(force[j] - force[j - 1]));
    return most;
}

double rangeOf(const Eigen::VectorXd& force) {
    double lo = kMissing, hi = -kMissing;
    for (const double f : force)
        if (std::isfinite(f)) {
            lo = std::min(lo, f);
            hi = std::max(hi, f);
        }
    return std::max(0.0, hi - lo);
}

void leaveOutForce(const RecordedRun& run, double from, double to, RowErrors& out) {
    for (Eigen::Index k = 0; k < run.time.size(); ++k)
        if (run.time[k] > from && run.time[k] < to)
            out.force[k] = kMissing;
}

void leaveOutMarkers(const RecordedRun& run, double from, double to, RowErrors& out) {
    const Eigen::Index seen = run.markerTime.size();
    for (Eigen::Index k = 0; k < seen; ++k)
        if (run.markerTime[k] > from && run.markerTime[k] < to)
            for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
                out.markers[c * seen + k] = kMissing;
}

/// @param noise smaller jumps are, N
/// @param least smaller ones, of a curve without noise, are none where the machine does not turn round, N
void leaveOutSnaps(const RecordedRun& run, const Eigen::VectorXd& force, double noise, double least,
                   const MisfitSettings& s, RowErrors& out) {
    const experiment::Readings readings{listOf(run.time), listOf(run.displacement), listOf(force)};
    const double dt = run.spacing(), snap = std::max(least, s.snapShare * rangeOf(force));
    for (const replay::Landmark& jump : replay::findLandmarks(readings, 0.0)) {
        const bool turns = atTurningPoint(run, jump.time);
        if (std::abs(jump.after - jump.before) < (turns ? noise : snap))
            continue;
        if (!turns)
            out.snaps.push_back(jump.time);
        const double before = turns ? s.turnRows * dt : s.snapBefore, after = turns ? s.turnRows * dt : s.snapAfter;
        leaveOutForce(run, jump.time - before, jump.time + after, out);
        if (!turns)
            leaveOutMarkers(run, jump.time - before, jump.time + after, out);
    }
}

/// Leaves out the rows beside places where the drive turns round, starts or stops at once. Free runs have none.
void leaveOutTurns(const RecordedRun& run, const MisfitSettings& s, RowErrors& out) {
    double fastest = 0.0;
    for (const Leg& leg : run.legs)
        fastest = std::max(fastest, std::abs(leg.speed));
    const double reach = s.turnRows * run.spacing();
    for (std::size_t l = 1; l < run.legs.size(); ++l) {
        const Leg &before = run.legs[l - 1], &after = run.legs[l];
        if (before.stroke != after.stroke && std::abs(after.speed - before.speed) > s.turnAtOnce * fastest)
            leaveOutForce(run, after.from - reach, after.from + reach, out);
    }
}

/// Leaves out markers where the simulated force has just fallen to nothing.
void leaveOutSwings(const RecordedRun& run, const Eigen::VectorXd& force, double peakForce, const MisfitSettings& s,
                    RowErrors& out) {
    const auto held = [&](Eigen::Index k) { return std::abs(force[k]) > s.free * peakForce; };
    for (Eigen::Index k = 1; k < force.size(); ++k)
        if (held(k - 1) && !held(k))
            leaveOutMarkers(run, run.time[k - 1], run.time[k] + s.swing, out);
}

/// Force that a curve has at once where it first is held, N: the straight line through the six rows behind, at that
/// row. A steep rise that goes on is none.
double jumpAtTouch(const Eigen::VectorXd& force, Eigen::Index k) {
    constexpr Eigen::Index kMean = 3;
    if (k < 1 || k + 2 * kMean >= force.size())
        return 0.0;
    const double near = force.segment(k + 1, kMean).mean(), far = force.segment(k + 1 + kMean, kMean).mean();
    const double slope = (far - near) / kMean; // of a row
    return near - 0.5 * (kMean + 1) * slope - force[k - 1];
}

/// Leaves out the rows within reach of a touch at which the force is there at once.
void leaveOutTouches(const RecordedRun& run, const Eigen::VectorXd& force, double least, double peakForce,
                     const MisfitSettings& s, RowErrors& out) {
    const auto held = [&](Eigen::Index k) { return std::abs(force[k]) > std::max(s.free * peakForce, 0.5 * least); };
    const double dt = run.spacing();
    for (Eigen::Index k = 1; k < force.size() && s.touchPlace > 0.0; ++k) {
        if (held(k - 1) || !held(k) || !(std::abs(jumpAtTouch(force, k)) > least))
            continue;
        const double speed = std::abs(run.legAt(run.time[k]).speed);
        if (speed == 0.0)
            continue;
        const double reach = std::max(0.5 * dt, s.touchPlace / speed); // s
        leaveOutForce(run, run.time[k - 1] - reach, run.time[k] + reach, out);
    }
}

/// What lies between jumps of one simulation and those of another.
Stretches betweenJumps(const RecordedRun& run, const Response& a, const Response& b, const MisfitSettings& s) {
    const auto p = jumpsOf(run, a, s), q = jumpsOf(run, b, s);
    const std::vector<int> partner = sameJumps(run, p, q, s.jumpFarthest);
    Stretches between;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (partner[i] >= 0)
            between.push_back(around(p[i].time, q[static_cast<std::size_t>(partner[i])].time, s));
    return between;
}

} // namespace

std::pair<double, double> around(double t0, double t1, const MisfitSettings& s) {
    return {std::min(t0, t1) - s.snapBefore, std::max(t0, t1) + s.snapAfter};
}

std::vector<replay::Landmark> jumpsOf(const RecordedRun& run, const Response& simulated, const MisfitSettings& s) {
    return simulatedJumps(run, simulated, 0.5 * s.snapShare);
}

MisfitSettings MisfitSettings::inEachOf(std::size_t n) const {
    MisfitSettings out = *this;
    out.repeated *= std::sqrt(static_cast<double>(std::max<std::size_t>(1, n)));
    return out;
}

double placeError(const Eigen::VectorXd& force, Eigen::Index k, double way, const MisfitSettings& s) {
    return way > 0.0 ? s.repeated * steepest(force, k) * std::min(1.0, s.contactPlace / way) : 0.0;
}

RowErrors rowErrors(const RecordedRun& run, const Noise& noise, const Response& fine, const Response& finer,
                    double peakForce, const MisfitSettings& s) {
    RowErrors out;
    const Eigen::Index n = run.force.size();
    out.force = Eigen::VectorXd::Constant(n, std::hypot(s.repeated * s.shareOfPeak * peakForce, noise.runToRun));
    out.markers = Eigen::VectorXd::Constant(run.markers.size(), std::hypot(noise.marker, s.repeated * s.markerPlace));
    double shortest = kMissing;
    for (const Stroke& stroke : run.strokes)
        if (stroke.phase != Phase::Hold)
            shortest = std::min(shortest, stroke.to - stroke.from);
    out.memory = std::isfinite(shortest) ? std::clamp(0.1 * shortest, 0.02, 3.0) : 1.0;
    const bool known = fine.failure.empty() && fine.force.size() == n;
    const bool both = known && finer.failure.empty() && finer.force.size() == n;
    const double dt = run.spacing();
    Eigen::VectorXd missing = Eigen::VectorXd::Zero(n);
    if (both) {
        Eigen::VectorXd apart = finer.force - fine.force;
        bridge(apart, run.time, out.force, rowsIn(betweenJumps(run, fine, finer, s), run.time));
        missing = (s.refinement * apart).unaryExpr([](double c) { return std::isfinite(c) ? c : 0.0; });
    }
    const bool elements = peakForce > 0.0; // free bodies have none: what differs there are steps
    out.correction = elements ? missing : Eigen::VectorXd::Zero(n);
    const auto reach = std::max<Eigen::Index>(2, static_cast<Eigen::Index>(out.memory / dt));
    for (Eigen::Index k = 0; k < n && known; ++k) {
        const Leg& leg = run.legs[static_cast<std::size_t>(run.leg[static_cast<std::size_t>(k)])];
        const double way = std::abs(leg.speed) * dt; // of the head from row to row
        const double place = placeError(fine.force, k, way, s);
        double grid = 0.0;
        if (both) {
            const Eigen::Index a = std::max<Eigen::Index>(0, k - reach), b = std::min(n, k + reach + 1);
            const auto near = missing.segment(a, b - a).array();
            const double mean = near.mean(), varies = (near - mean).square().mean();
            grid = s.repeated * std::hypot(std::sqrt(varies), (elements ? s.uncorrected : 1.0) * mean);
        }
        out.force[k] = std::sqrt(out.force[k] * out.force[k] + place * place + grid * grid);
    }
    for (Eigen::Index k = 0; k < run.markers.size(); ++k) {
        if (both && fine.markers.size() == run.markers.size() && finer.markers.size() == run.markers.size())
            out.markers[k] =
                std::hypot(out.markers[k], s.repeated * s.refinement * (finer.markers[k] - fine.markers[k]));
        if (!std::isfinite(run.markers[k]) || !std::isfinite(out.markers[k]))
            out.markers[k] = kMissing;
    }
    const double visible = s.jumpNoise * noise.total();
    leaveOutSnaps(run, run.force, visible, visible, s, out);
    if (known)
        leaveOutSnaps(run, fine.force, visible, 0.0, s, out);
    leaveOutTurns(run, s, out);
    if (elements) // of a driven specimen
        leaveOutTouches(run, run.force, visible, peakForce, s, out);
    if (known && elements) {
        leaveOutTouches(run, fine.force, visible, peakForce, s, out);
        leaveOutSwings(run, fine.force, peakForce, s, out);
    }
    for (Eigen::Index k = 0; k < n; ++k)
        if (!std::isfinite(run.force[k]) || !std::isfinite(out.force[k]) ||
            (known && !std::isfinite(fine.force[k]))) // the last sample may come later than the drive's end
            out.force[k] = kMissing;
    return out;
}

} // namespace supercircle::diagnosis
