#pragma once
// Rounded numbers for people: what printf's %.3g and %.2f print in the C locale, in any locale.

#include <string>

namespace supercircle::record {

/// `digits` significant digits, with an exponent where the number is very small or large (%.Ng).
[[nodiscard]] std::string rounded(double value, int digits);

/// `decimals` digits behind the point (%.Nf).
[[nodiscard]] std::string fixed(double value, int decimals);

/// "12 s", "3 min 20 s", "2 h 05 min".
[[nodiscard]] std::string duration(double seconds);

} // namespace supercircle::record
