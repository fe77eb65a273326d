#pragma once
// Comparison of recorded and simulated readings: pointwise errors and landmarks.
//
// At a snap or slip-off the force falls within a sample or two. A shift of micrometres then gives an error as large as
// the force, and the following spike depends on inertia and integrator. Such jumps are matched by their displacement,
// and an interval around them is excluded from pointwise errors.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/experiment.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace supercircle::replay {

/// A sudden change of the force.
struct Landmark {
    double time = 0.0;         ///< s, at half of the jump
    double displacement = 0.0; ///< m, at that time
    double before = 0.0;       ///< N, force before
    double after = 0.0;        ///< N, force after
};

/// Jumps larger than `share` of the force's range within two samples, and three times larger than the slopes on either
/// side. Ordered by time.
std::vector<Landmark> findLandmarks(const experiment::Readings& readings, double share = 0.15);

/// Times at which a simulation passed the middle of each jump, by its own steps, s.
std::vector<double> jumpTimes(const Simulated& simulated);

/// Pairs of indices into a and b of jumps with equal direction, nearest in time first, at most `farthest` seconds
/// apart; ordered by a.
std::vector<std::pair<std::size_t, std::size_t>> matchLandmarks(const std::vector<Landmark>& a,
                                                                const std::vector<Landmark>& b, double farthest);

/// Errors of a channel beside the first one, SI unit, in rows that are not excluded.
struct ChannelComparison {
    double peakRecorded = 0.0, peakSimulated = 0.0, rmse = 0.0;
    double maxError = 0.0, maxErrorAt = 0.0; ///< s, its time
    std::vector<double> residual;            ///< simulated minus recorded; NaN where one is missing
};

struct Comparison {
    double peakRecorded = 0.0; ///< N, largest |force|
    double peakSimulated = 0.0;
    double rmse = 0.0;             ///< N, force, without excluded rows
    double residualMean = 0.0;     ///< N, mean residual of these rows (the zero of a recording is a noisy mean)
    double rmseAboutMean = 0.0;    ///< N, rmse about that mean
    double maxError = 0.0;         ///< N, of the same rows
    double maxErrorAt = 0.0;       ///< s, its time
    double rmseAll = 0.0;          ///< N, force, all rows
    double excludedFraction = 0.0; ///< fraction of excluded rows
    double markerRmse = 0.0;       ///< m, distance of markers, without excluded rows
    double markerMax = 0.0;
    std::vector<Landmark> recorded, simulated;
    std::vector<std::pair<std::size_t, std::size_t>> matches; ///< indices of the same event in recorded and simulated
    std::vector<double> residual; ///< N, simulated minus recorded force; NaN where one is missing
    std::vector<bool> excluded;   ///< whether a row is excluded
    std::vector<ChannelComparison> further;
};

/// Errors of a law that was found elsewhere, where only the stated numbers are fitted, in the unit of the channel.
struct LawScore {
    double rmseWithout = 0.0, rmseWith = 0.0;       ///< of all readings
    double heldOutWithout = 0.0, heldOutWith = 0.0; ///< of readings that are left out in turn
    double gain = 0.0, gainError = 0.0;             ///< in held-out log score, and its standard error
};

/// Interval excluded around landmarks; the defaults are those of the reference specimen.
struct ExclusionWindow {
    double before = 0.1;   ///< s, before the earlier of the two
    double after = 0.3;    ///< s, after the later of the two
    double farthest = 1.0; ///< s, larger distances mean different events

    /// The same for a set-up.
    [[nodiscard]] ExclusionWindow in(const experiment::NaturalUnits& units) const {
        return {before * units.time, after * units.time, farthest * units.time};
    }
};

/// Compares a recorded run with its simulation.
/// @param jumps whether sudden changes are treated as landmarks (not for poses)
Comparison compare(const experiment::Run& run, const Simulated& simulated, const ExclusionWindow& window = {},
                   bool jumps = true);

} // namespace supercircle::replay
