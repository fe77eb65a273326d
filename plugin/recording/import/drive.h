#pragma once
// Piecewise linear drive behind a displacement signal.

#include <string>
#include <vector>

namespace supercircle::importing {

struct Drive {
    std::vector<double> time;         ///< break points, s
    std::vector<double> displacement; ///< at the break points, m
    double tolerance = 0.0;           ///< m, requested tolerance
    double largestDistance = 0.0;     ///< m, largest distance of a sample from the segments
    double noise = 0.0;               ///< m, standard deviation of the signal's white noise
};

/// Finds the smallest number of linear segments within a tolerance of the samples. Missing samples (NaN) are ignored.
/// @param time s, increasing, at least two existing samples
/// @param tolerance m; 0: the largest of five times the noise, its resolution, 0.05 % of the travel and 1 um
Drive findDrive(const std::vector<double>& time, const std::vector<double>& displacement, double tolerance = 0.0);

} // namespace supercircle::importing
