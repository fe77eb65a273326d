#pragma once
// What the readings of a run that was not made are worth: behind the sensors' noise and what simulations are off by, as
// those of recorded runs are (misfit.h), with what every run has of its own integrated out: a shift and the scale of
// its force, its clock, and a shift of each coordinate of each marker while the machine goes one way, and behind a
// snap.

#include "plugin/diagnosis/model.h"
#include "plugin/diagnosis/noise.h"

#include <Eigen/Core>
#include <cstddef>

namespace supercircle::diagnosis {

/// Products in noise units, C' W C, of changes of the readings of so many repeats of a run; what simulations are off by
/// is the same in all of them.
/// @param like the run as it is foretold; at least 8 readings
/// @param columns C, a column each: force, N, then markers, m, as in `like`
Eigen::MatrixXd seenProducts(const Design& design, const DesignResponse& like, const Noise& noise,
                             const Eigen::MatrixXd& columns, std::size_t repeats);

} // namespace supercircle::diagnosis
