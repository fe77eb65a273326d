#pragma once
// A column of velocities: it stands for a displacement that is not there, or checks it.

#include "plugin/recording/import/import.h"

namespace supercircle::importing {

/// Takes the velocities out of a run with times. Beside a force without a displacement they become one, by the
/// trapezoidal rule.
/// @return velocities, m/s, one a row; empty: there are none, or they became the displacement
std::vector<double> takeVelocity(Signals& signals, std::vector<Remark>& remarks);

/// Compares the way of the velocities, one a row of the run, with that of the drive; a factor of two between them is
/// doubtful.
void compareVelocity(ImportedRun& run, const std::vector<double>& velocity);

} // namespace supercircle::importing
