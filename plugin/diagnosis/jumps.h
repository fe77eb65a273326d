#pragma once
// Jumps (a snap, a slip-off, the first touch of a strip) as what they are to a fit: one observation each, their place.
//
// Row by row a jump that is foretold a little too late is wrong by its whole height in every row in between: 1.4 N for
// 6 mN of noise, in as many rows as the sampling happens to put there. Leaving a fixed window out around the recorded
// jump (and the nominal simulation's) only moves that cliff: a fit saw nothing until a jump left the window and then
// everything, its derivatives knew neither, and a forecast of an unseen run stood or fell with a parameter's last
// digit. A sound strip was called "static friction 1.01" for it (probability .95, all of it gained in 13 rows).
//
// So rows between a recorded jump and the simulated one that belongs to it say nothing, whichever simulation is looked
// at (bridge), and how far the two lie apart is a row of its own with its own error: the recorded one lies somewhere
// between two readings, and with true parameters two simulators of different kinds agree to .2 rows in 150 jumps of 60
// concealed experiments, in five (strips that slip off) to a row, .5 to 1 % of the travel.

#include "plugin/diagnosis/data.h"
#include "plugin/diagnosis/model.h"
#include "plugin/replay/compare.h"

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// Whether the drive turns round or stops there: a jump at a turning point is friction or viscosity turning round,
/// known to a row.
bool atTurningPoint(const RecordedRun& run, double time);

/// Index of the leg of the drive at a time, -1 where there is none.
int legOf(const RecordedRun& run, double time);

/// Jumps of a curve at the run's own times while the drive moves, turning points left out.
/// @param share of the force range within two rows
std::vector<replay::Landmark> jumpsOf(const RecordedRun& run, const Eigen::VectorXd& force, double share);
/// Those of a simulation, at the times where it passed them rather than at its readings.
std::vector<replay::Landmark> jumpsOf(const RecordedRun& run, const Response& simulated, double share);

/// Indices of jumps of two curves that are one event: in one leg of the drive, within `farthest` of its duration.
std::vector<std::pair<std::size_t, std::size_t>> sameJumps(const RecordedRun& run,
                                                           const std::vector<replay::Landmark>& a,
                                                           const std::vector<replay::Landmark>& b, double farthest);

/// Replaces differences in (from, to) by a straight line between what stands on either side (means of three rows that
/// count); nothing where neither side has any.
/// @param errors of the rows; infinite: does not count, is left as it is
void bridge(Eigen::Ref<Eigen::VectorXd> difference, const Eigen::VectorXd& time,
            const Eigen::Ref<const Eigen::VectorXd>& errors, double from, double to);

} // namespace supercircle::diagnosis
