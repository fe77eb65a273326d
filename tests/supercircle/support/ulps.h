#pragma once
// Errors in units in the last place of the right result, against long double where it has more digits.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace supercircle::test {

/// Distance from the long double value in units in the last place of its double; huge if one is finite and the other
/// not.
inline double ulps(double value, long double exact) {
    const double size = std::abs(static_cast<double>(exact));
    if (std::isnan(value) || std::isinf(value) || std::isinf(size) || std::isnan(size))
        return (std::isnan(value) && std::isnan(size)) || value == static_cast<double>(exact) ? 0.0 : 1e300;
    const double next = std::nextafter(size, std::numeric_limits<double>::infinity());
    const double unit = std::isinf(next) ? size - std::nextafter(size, 0.0) : next - size;
    return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / unit);
}

/// The same numbers in every run (splitmix64 of S. Vigna).
class Numbers {
public:
    /// In [a, b).
    double uniform(double a, double b) { return a + (b - a) * (static_cast<double>(next() >> 11U) * 0x1p-53); }
    /// In [a, b) with uniform exponent, 0 < a < b.
    double exponents(double a, double b) { return std::clamp(std::exp(uniform(std::log(a), std::log(b))), a, b); }

private:
    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
        z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
        return z ^ (z >> 31U);
    }
    std::uint64_t state_ = 1;
};

} // namespace supercircle::test
