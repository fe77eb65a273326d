#pragma once
// Readings while the crosshead rests: they show noise without physics.

#include "plugin/identification/diagnosis/data.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

/// A dwell interval and its trends.
struct DwellInterval {
    std::size_t run = 0;
    Eigen::VectorXd time, force; ///< s, N
    Eigen::MatrixXd trends;      ///< columns: mean and, after a motion, slope and logarithm of time (relaxation)
};

/// The recordings with a missing row between two levels of each run that was read at rest alone, three times or more at
/// each level: the way from one level to the next is no noise. Only times and readings have the new rows.
RecordedData levelsApart(RecordedData data);

std::vector<DwellInterval> dwellIntervalsOf(const RecordedData& data);

/// Restricted log likelihood of white plus AR(1) noise (N, N, s), the trends integrated out.
double restrictedLogLikelihood(const DwellInterval& dwell, double white, double correlated, double correlationTime);

} // namespace supercircle::diagnosis
