#pragma once
// The commanded motion behind a displacement signal: straight legs between break points.

#include <string>
#include <vector>

namespace supercircle::importing {

struct Drive {
    std::vector<double> time;         ///< break points, s
    std::vector<double> displacement; ///< there, m
    double tolerance = 0.0;           ///< m, what was asked for
    double deviation = 0.0;           ///< m, largest distance of a sample from the legs
    double noise = 0.0;               ///< m, standard deviation of the signal's white noise
};

/// Fewest straight legs that follow the samples within a tolerance. Missing samples (NaN) are passed over.
/// @param time increasing, at least two samples that are there
/// @param tolerance m; 0: the largest of five times the signal's noise, its resolution, 0.05 % of the travel and 1 um
Drive findDrive(const std::vector<double>& time, const std::vector<double>& displacement, double tolerance = 0.0);

} // namespace supercircle::importing
