#pragma once
// Jumps (a snap, a slip-off, the first touch of a strip) as what they are to a fit: one observation each, their place.
//
// Row by row a jump that is foretold a little too late is wrong by its whole height in every row in between: 1.4 N for
// 6 mN of noise, in as many rows as the sampling happens to put there. Leaving a fixed window out around the recorded
// jump only moves that cliff: a fit saw nothing until a jump left the window and then everything, its derivatives knew
// neither, and a forecast of an unseen run stood or fell with a parameter's last digit. A sound strip was called
// "static friction 1.01" for it (probability .95, all of it gained in 13 rows).
//
// So rows between a recorded jump and the simulated one that belongs to it say nothing, whichever simulation is looked
// at (bridge), and how far the two lie apart is a row of its own with its own error: the recorded one lies somewhere
// between two readings, and with true parameters two simulators of different kinds agree to .2 rows in 150 jumps of 60
// concealed experiments, in five (strips that slip off) to a row, .5 to 1 % of the travel. That second error is one of
// the simulator, the same for one event in every cycle of a run. A simulation without the jump is as far off as one may
// be: were it free, softening a snap until it is none would pay.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/replay/compare.h"

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// Whether the drive turns round or stops there: a jump at a turning point is friction or viscosity turning round,
/// known to a row.
bool atTurningPoint(const RecordedRun& run, double time);

/// What was recorded: jumps while the drive moves, away from turning points.
/// @param share of the force range within two rows
/// @param least smaller ones are noise, N
std::vector<replay::Landmark> recordedJumps(const RecordedRun& run, double share, double least);
/// Those of a simulation while the drive moves, at the times where it passed them rather than at its readings.
std::vector<replay::Landmark> simulatedJumps(const RecordedRun& run, const Response& simulated, double share);

/// How far apart two jumps may lie that are one event, s: a share of the drive's stroke.
double reachOf(const RecordedRun& run, double time, double share);

/// Which of b each of a is, -1: none. One event has the same direction in both, lies in the same stroke and within
/// reach; their order is kept, and the sum of distances is the least with that many pairs.
std::vector<int> sameJumps(const RecordedRun& run, const std::vector<replay::Landmark>& a,
                           const std::vector<replay::Landmark>& b, double share);

/// Stretches of time, s.
using Stretches = std::vector<std::pair<double, double>>;

/// Rows in any of the stretches.
std::vector<bool> rowsIn(const Stretches& stretches, const Eigen::VectorXd& time);

/// Replaces differences in hidden rows by straight lines between what stands on either side (means of three rows that
/// count and are not hidden); nothing where neither side has any.
/// @param errors of the rows; infinite: does not count, is left as it is
void bridge(Eigen::Ref<Eigen::VectorXd> difference, const Eigen::VectorXd& time,
            const Eigen::Ref<const Eigen::VectorXd>& errors, const std::vector<bool>& hidden);

} // namespace supercircle::diagnosis
