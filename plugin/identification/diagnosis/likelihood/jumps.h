#pragma once
// Jumps of the force (a snap, a slip-off, first contact of a strip). Each is one observation: its time.
//
// A jump predicted a little late is wrong by its whole height in every row between. Those rows are therefore masked
// (interpolateMasked), and the difference of the two times is a residual of its own. Its error has a part of the
// sampling and a part of the simulator, which is common to one event in every cycle. A simulation without the jump gets
// the largest distance allowed. Otherwise softening a snap away would cost nothing (decision 0075).

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/replay/compare.h"

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// The recorded times and displacements with this force, N.
experiment::Readings readingsOf(const RecordedRun& run, const Eigen::VectorXd& force);

/// Whether the drive reverses or stops near this time. A jump there is friction or viscosity changing sign, known to a
/// row.
bool atReversal(const RecordedRun& run, double time);

/// Recorded jumps while the drive moves, away from reversals.
/// @param share smallest jump as a share of the force range within two rows
/// @param least smaller jumps are noise, N
std::vector<replay::Landmark> recordedJumps(const RecordedRun& run, double share, double least);
/// Simulated jumps while the drive moves, at the times of the simulation rather than of its readings.
std::vector<replay::Landmark> simulatedJumps(const RecordedRun& run, const Response& simulated, double share);

/// Largest distance between two jumps that are one event, s: a share of the stroke's duration.
double jumpReachOf(const RecordedRun& run, double time, double share);

/// Index in b of the same event for each jump of a, -1: none. One event has the same direction, stroke and order, and
/// lies within reach. The sum of distances is minimal.
std::vector<int> matchJumps(const RecordedRun& run, const std::vector<replay::Landmark>& a,
                            const std::vector<replay::Landmark>& b, double share);

/// Intervals of time [from, to], s.
using TimeRanges = std::vector<std::pair<double, double>>;

/// Rows inside any of the intervals.
std::vector<bool> rowsInside(const TimeRanges& stretches, const Eigen::VectorXd& time);

/// Replaces differences in masked rows by straight lines between both sides (means of three unmasked rows that count).
/// Does nothing where neither side has such rows.
/// @param errors of the rows; infinite: does not count and is left as it is
void interpolateMasked(Eigen::Ref<Eigen::VectorXd> difference, const Eigen::VectorXd& time,
                       const Eigen::Ref<const Eigen::VectorXd>& errors, const std::vector<bool>& masked);

} // namespace supercircle::diagnosis
