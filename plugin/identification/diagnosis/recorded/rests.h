#pragma once
// Readings while the head stands still: where noise is told from everything else.

#include "plugin/identification/diagnosis/data.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

/// A stretch of rest and what is taken out of it.
struct Rest {
    std::size_t run = 0;
    Eigen::VectorXd time, force; ///< s, N
    Eigen::MatrixXd trends;      ///< columns: mean and, behind a motion, slope and logarithm of time: it may relax
};

std::vector<Rest> restsOf(const Data& data);

/// Of white and first-order coloured noise (N, N, s), the trends' share integrated out.
double restrictedLogLikelihood(const Rest& rest, double white, double coloured, double memory);

} // namespace supercircle::diagnosis
