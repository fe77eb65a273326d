#pragma once
// Computational noise of simulated readings. An adaptive solver is not smooth: other steps, contacts and rounding
// change a reading slightly from one parameter value to the next. Derivatives need steps with larger effects.

#include <cstddef>
#include <vector>

namespace supercircle::sensitivity {

/// Standard deviation of the computational noise from values at equally spaced points close together, by third
/// differences:
/// sigma^2 = (3!)^2 / 6! * mean of (third difference)^2.
/// @return 0 with fewer than four values; NaN if a value is NaN
/// @source J. J. More, S. M. Wild, "Estimating computational noise", SIAM J. Sci. Comput. 33 (2011), eq. (2.4)
double computationalNoise(const std::vector<double>& values);

/// Root mean square over `width` entries to either side, without NaN entries.
std::vector<double> smoothedRms(const std::vector<double>& values, std::size_t width);

} // namespace supercircle::sensitivity
