#pragma once
// Recorded and simulated readings side by side: errors, and landmarks where errors of a curve mean nothing.
//
// At a snap or where a tip slips off, the force falls within a sample or two. A shift of a few micrometres then makes a
// pointwise error as large as the force itself, and the height of the spike that follows depends on inertia and on the
// damping of the integrator. Such jumps are found in both curves and compared by where they happen; a window around
// them is left out of the pointwise figures.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/experiment.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace supercircle::replay {

/// A sudden change of the force.
struct Landmark {
    double time = 0.0;         ///< where the force passes half of the jump, s
    double displacement = 0.0; ///< there, m
    double before = 0.0;       ///< force, N
    double after = 0.0;        ///< N
};

/// Jumps larger than `share` of the force's range within two samples that stand out from the slopes on either side by a
/// factor of three. In the order of time.
std::vector<Landmark> findLandmarks(const experiment::Readings& readings, double share = 0.15);

/// When a simulation passed the middle of each jump that its readings show, by its own steps, s.
std::vector<double> jumpTimes(const Simulated& simulated);

/// Pairs (index into a, index into b) of jumps of the same direction, nearest in time first, at most `farthest` seconds
/// apart; in the order of a.
std::vector<std::pair<std::size_t, std::size_t>> matchLandmarks(const std::vector<Landmark>& a,
                                                                const std::vector<Landmark>& b, double farthest);

struct Comparison {
    double peakRecorded = 0.0; ///< largest |force|, N
    double peakSimulated = 0.0;
    double rmse = 0.0;       ///< force, outside the windows, N
    double zero = 0.0;       ///< mean of the residual there, N: the recording's zero is a mean of noise itself
    double rmseZeroed = 0.0; ///< rmse with that mean taken off, N
    double maxError = 0.0;   ///< the same, N
    double maxErrorAt = 0.0; ///< its time, s
    double rmseAll = 0.0;    ///< force, windows included, N
    double leftOut = 0.0;    ///< share of the rows inside windows, 1
    double markerRmse = 0.0; ///< distance of markers, outside the windows, m
    double markerMax = 0.0;
    std::vector<Landmark> recorded, simulated;
    std::vector<std::pair<std::size_t, std::size_t>> matches; ///< recorded, simulated: indices of the same event
    std::vector<double> residual; ///< simulated minus recorded force of each row, N; NaN where one is missing
    std::vector<bool> inWindow;   ///< of each row
};

/// What is left out around landmarks.
struct Window {
    double before = 0.1;   ///< ahead of the earlier of the two, s
    double after = 0.3;    ///< behind the later of the two, s
    double farthest = 1.0; ///< landmarks of the two curves farther apart are different events, s
};

/// Compares what was recorded in `run` with its simulation. `jumps`: sudden changes are events; without, they are
/// compared like everything else (poses have none).
Comparison compare(const experiment::Run& run, const Simulated& simulated, const Window& window = {},
                   bool jumps = true);

} // namespace supercircle::replay
