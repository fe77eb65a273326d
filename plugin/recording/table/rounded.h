#pragma once
// Rounded numbers for people: what printf's %.3g and %.2f print in the C locale, in any locale.

#include <string>

namespace supercircle::record {

/// `digits` significant digits, with an exponent where the number is very small or large (%.Ng).
[[nodiscard]] std::string rounded(double value, int digits);

/// `decimals` digits behind the point (%.Nf).
[[nodiscard]] std::string fixed(double value, int decimals);

} // namespace supercircle::record
