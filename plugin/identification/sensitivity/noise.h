#pragma once
// How rough a simulated reading is as a function of its parameters.
//
// An adaptive solver is not smooth: other steps, other contacts, other rounding change a reading by a small amount from
// one parameter value to the next. Derivatives must be taken over steps that stand out of it.

#include <cstddef>
#include <vector>

namespace supercircle::sensitivity {

/// Standard deviation of the rough part of a function from its values at equally spaced points close together, by
/// differences of third order, which a smooth function does not have:
///   sigma^2 = (3!)^2 / 6! * mean of (third difference)^2.
/// @return 0 with fewer than four values; values that are NaN make the result NaN
/// @source J. J. More, S. M. Wild, "Estimating computational noise", SIAM J. Sci. Comput. 33 (2011), eq. (2.4)
double roughness(const std::vector<double>& values);

/// Root of the mean square over a window of `width` entries to either side; NaN entries are passed over.
std::vector<double> smoothedRms(const std::vector<double>& values, std::size_t width);

} // namespace supercircle::sensitivity
