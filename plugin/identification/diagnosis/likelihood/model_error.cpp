#include "plugin/identification/diagnosis/likelihood/model_error.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

constexpr double kMissing = std::numeric_limits<double>::infinity();

/// Largest change of the simulated force from row to row within two rows, N.
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

void excludeForce(const RecordedRun& run, double from, double to, ModelError& out) {
    for (Eigen::Index k = 0; k < run.time.size(); ++k)
        if (run.time[k] > from && run.time[k] < to)
            out.force[k] = kMissing;
}

void excludeMarkers(const RecordedRun& run, double from, double to, ModelError& out) {
    const Eigen::Index frames = run.markerTime.size();
    for (Eigen::Index k = 0; k < frames; ++k)
        if (run.markerTime[k] > from && run.markerTime[k] < to)
            for (Eigen::Index c = 0; c < 2 * static_cast<Eigen::Index>(run.markerCount); ++c)
                out.markers[c * frames + k] = kMissing;
}

/// Excludes rows around snaps.
/// @param noise smallest jump at a reversal, N
/// @param least smallest jump elsewhere, N
void excludeSnaps(const RecordedRun& run, const Eigen::VectorXd& force, double noise, double least,
                  const LikelihoodSettings& s, ModelError& out) {
    const experiment::Readings readings = readingsOf(run, force);
    const double dt = run.spacing(), snap = std::max(least, s.snapShare * rangeOf(force));
    for (const replay::Landmark& jump : replay::findLandmarks(readings, 0.0)) {
        const bool turns = atReversal(run, jump.time);
        if (std::abs(jump.after - jump.before) < (turns ? noise : snap))
            continue;
        if (!turns)
            out.snaps.push_back(jump.time);
        const double before = turns ? s.reversalRows * dt : s.snapBefore,
                     after = turns ? s.reversalRows * dt : s.snapAfter;
        excludeForce(run, jump.time - before, jump.time + after, out);
        if (!turns)
            excludeMarkers(run, jump.time - before, jump.time + after, out);
    }
}

/// Excludes the rows beside abrupt reversals, starts and stops of the drive. Free runs have none.
void excludeReversals(const RecordedRun& run, const LikelihoodSettings& s, ModelError& out) {
    double fastest = 0.0;
    for (const DriveSegment& segment : run.segments)
        fastest = std::max(fastest, std::abs(segment.speed));
    const double reach = s.reversalRows * run.spacing();
    for (std::size_t l = 1; l < run.segments.size(); ++l) {
        const DriveSegment &before = run.segments[l - 1], &after = run.segments[l];
        if (before.stroke != after.stroke && std::abs(after.speed - before.speed) > s.abruptReversal * fastest)
            excludeForce(run, after.from - reach, after.from + reach, out);
    }
}

/// Excludes markers while a released specimen oscillates.
void excludeReleases(const RecordedRun& run, const Eigen::VectorXd& force, double peakForce,
                     const LikelihoodSettings& s, ModelError& out) {
    const auto held = [&](Eigen::Index k) { return std::abs(force[k]) > s.releasedShare * peakForce; };
    for (Eigen::Index k = 1; k < force.size(); ++k)
        if (held(k - 1) && !held(k))
            excludeMarkers(run, run.time[k - 1], run.time[k] + s.releaseOscillation, out);
}

/// Force present immediately at first contact, N: the straight line through the next six rows, extrapolated. A
/// continued steep rise gives none.
double jumpAtContact(const Eigen::VectorXd& force, Eigen::Index k) {
    constexpr Eigen::Index kMean = 3;
    if (k < 1 || k + 2 * kMean >= force.size())
        return 0.0;
    const double near = force.segment(k + 1, kMean).mean(), far = force.segment(k + 1 + kMean, kMean).mean();
    const double slope = (far - near) / kMean; // N per row
    return near - 0.5 * (kMean + 1) * slope - force[k - 1];
}

/// Excludes the rows near a contact at which the force is present immediately.
void excludeContacts(const RecordedRun& run, const Eigen::VectorXd& force, double least, double peakForce,
                     const LikelihoodSettings& s, ModelError& out) {
    const auto held = [&](Eigen::Index k) {
        return std::abs(force[k]) > std::max(s.releasedShare * peakForce, 0.5 * least);
    };
    const double dt = run.spacing();
    for (Eigen::Index k = 1; k < force.size() && s.contactAccuracy > 0.0; ++k) {
        if (held(k - 1) || !held(k) || !(std::abs(jumpAtContact(force, k)) > least))
            continue;
        const double speed = std::abs(run.segmentAt(run.time[k]).speed);
        if (speed == 0.0)
            continue;
        const double reach = std::max(0.5 * dt, s.contactAccuracy / speed); // s
        excludeForce(run, run.time[k - 1] - reach, run.time[k] + reach, out);
    }
}

/// Intervals between the jumps of one simulation and the same jumps of another.
TimeRanges rangesBetweenJumps(const RecordedRun& run, const Response& a, const Response& b,
                              const LikelihoodSettings& s) {
    const auto p = jumpsOf(run, a, s), q = jumpsOf(run, b, s);
    const std::vector<int> partner = matchJumps(run, p, q, s.jumpReach);
    TimeRanges between;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (partner[i] >= 0)
            between.push_back(maskedRange(p[i].time, q[static_cast<std::size_t>(partner[i])].time, s));
    return between;
}

} // namespace

std::pair<double, double> maskedRange(double t0, double t1, const LikelihoodSettings& s) {
    return {std::min(t0, t1) - s.snapBefore, std::max(t0, t1) + s.snapAfter};
}

std::vector<replay::Landmark> jumpsOf(const RecordedRun& run, const Response& simulated, const LikelihoodSettings& s) {
    return simulatedJumps(run, simulated, 0.5 * s.snapShare);
}

LikelihoodSettings LikelihoodSettings::in(const experiment::NaturalUnits& units) const {
    LikelihoodSettings out = *this;
    for (double* length :
         {&out.contactPosition, &out.markerAccuracy, &out.markerShift, &out.snapPositionError, &out.contactAccuracy})
        *length *= units.length;
    for (double* time : {&out.releaseOscillation, &out.snapBefore, &out.snapAfter})
        *time *= units.time;
    return out;
}

LikelihoodSettings LikelihoodSettings::of(const RecordedData& data) const {
    constexpr double kNever = 1e9; // times any change
    LikelihoodSettings out = *this;
    out.discretised = !data.freeBodies();
    if (data.drivesLoad)
        out.contactPosition = out.contactAccuracy = 0.0;
    if (data.table) {
        out.clockError = out.contactAccuracy = 0.0;
        out.abruptReversal = out.snapShare = out.jumpNoise = kNever;
    }
    return out;
}

LikelihoodSettings LikelihoodSettings::forRepeats(std::size_t n) const {
    LikelihoodSettings out = *this;
    out.repeatFactor *= std::sqrt(static_cast<double>(std::max<std::size_t>(1, n)));
    return out;
}

double positionError(const Eigen::VectorXd& force, Eigen::Index k, double travel, const LikelihoodSettings& s) {
    return travel > 0.0 ? s.repeatFactor * steepest(force, k) * std::min(1.0, s.contactPosition / travel) : 0.0;
}

ModelError modelErrorOf(const RecordedRun& run, const Noise& noise, const Response& fine, const Response& finer,
                        double peakForce, const LikelihoodSettings& s) {
    ModelError out;
    const Eigen::Index n = run.force.size();
    out.force = Eigen::VectorXd::Constant(n, math::hypot(s.repeatFactor * s.shareOfPeak * peakForce, noise.runToRun));
    out.markers =
        Eigen::VectorXd::Constant(run.markers.size(), math::hypot(noise.marker, s.repeatFactor * s.markerAccuracy));
    double shortest = kMissing;
    for (const Stroke& stroke : run.strokes)
        if (stroke.phase != Phase::Hold)
            shortest = std::min(shortest, stroke.to - stroke.from);
    out.correlationTime = std::isfinite(shortest)
                              ? std::clamp(0.1 * shortest, 0.02 * run.units.time, 3.0 * run.units.time)
                              : run.units.time;
    const bool known = fine.failure.empty() && fine.force.size() == n;
    const bool both = known && finer.failure.empty() && finer.force.size() == n;
    const double dt = run.spacing();
    Eigen::VectorXd correction = Eigen::VectorXd::Zero(n);
    if (both) {
        Eigen::VectorXd difference = finer.force - fine.force;
        interpolateMasked(difference, run.time, out.force,
                          rowsInside(rangesBetweenJumps(run, fine, finer, s), run.time));
        correction = (s.refinement * difference).unaryExpr([](double c) { return std::isfinite(c) ? c : 0.0; });
    }
    const bool driven = peakForce > 0.0;
    out.correction = s.discretised ? correction : Eigen::VectorXd::Zero(n);
    const auto reach = std::max<Eigen::Index>(2, static_cast<Eigen::Index>(out.correlationTime / dt));
    for (Eigen::Index k = 0; k < n && known; ++k) {
        const DriveSegment& segment =
            run.segments[static_cast<std::size_t>(run.segmentOfRow[static_cast<std::size_t>(k)])];
        const double travel = std::abs(segment.speed) * dt; // m, travel of the crosshead from row to row
        const double position = positionError(fine.force, k, travel, s);
        double discretisation = 0.0;
        if (both) {
            const Eigen::Index a = std::max<Eigen::Index>(0, k - reach), b = std::min(n, k + reach + 1);
            const auto near = correction.segment(a, b - a).array();
            const double mean = near.mean(), varies = (near - mean).square().mean();
            discretisation =
                s.repeatFactor * math::hypot(std::sqrt(varies), (s.discretised ? s.uncorrected : 1.0) * mean);
        }
        out.force[k] = std::sqrt(out.force[k] * out.force[k] + position * position + discretisation * discretisation);
    }
    for (Eigen::Index k = 0; k < run.markers.size(); ++k) {
        if (both && fine.markers.size() == run.markers.size() && finer.markers.size() == run.markers.size())
            out.markers[k] =
                math::hypot(out.markers[k], s.repeatFactor * s.refinement * (finer.markers[k] - fine.markers[k]));
        if (!std::isfinite(run.markers[k]) || !std::isfinite(out.markers[k]))
            out.markers[k] = kMissing;
    }
    const double visible = s.jumpNoise * noise.total();
    excludeSnaps(run, run.force, visible, visible, s, out);
    if (known)
        excludeSnaps(run, fine.force, visible, 0.0, s, out);
    excludeReversals(run, s, out);
    if (driven)
        excludeContacts(run, run.force, visible, peakForce, s, out);
    if (known && driven) {
        excludeContacts(run, fine.force, visible, peakForce, s, out);
        excludeReleases(run, fine.force, peakForce, s, out);
    }
    for (Eigen::Index k = 0; k < n; ++k)
        if (!std::isfinite(run.force[k]) || !std::isfinite(out.force[k]) ||
            (known && !std::isfinite(fine.force[k]))) // the last sample may lie after the end of the drive
            out.force[k] = kMissing;
    return out;
}

} // namespace supercircle::diagnosis
