// Powers and roots. pow is the exponential of y log(x), both in two words. The cube root has the start and the
// polynomial of s_cbrt.c of FreeBSD's fdlibm (Sun Microsystems 1993, B. D. Evans) and one step of Newton.

#include "supercircle/support/elementary.h"
#include "supercircle/support/elementary/exponential.h"
#include "supercircle/support/elementary/wide.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace supercircle::math {

namespace {

bool isInteger(double y) {
    return std::floor(y) == y; // true for infinities
}

bool isOdd(double y) {
    return std::abs(y) < 0x1p53 && isInteger(y) && !isInteger(0.5 * y);
}

/// Of 0 < x < infinity other than 1 and finite y other than 0.
double powerOfPositive(double x, double y) {
    const Wide l = wideLogarithm(x);
    const double rough = y * l.hi;
    if (rough > 710.0)
        return kInfinity;
    if (rough < -746.0)
        return 0.0;
    if (std::abs(rough) < 0x1p-60)
        return 1.0;
    const Wide p = product(y, l.hi); // |y| is below 2^63 here: no logarithm is smaller than 2^-53
    return exponential(sumOfOrdered(p.hi, p.lo + y * l.lo));
}

} // namespace

double pow(double x, double y) {
    if (y == 0.0 || x == 1.0)
        return 1.0;
    if (std::isnan(x) || std::isnan(y))
        return std::numeric_limits<double>::quiet_NaN();
    const double size = std::abs(x);
    if (std::isinf(y))
        return size == 1.0 ? 1.0 : (size > 1.0) == (y > 0.0) ? kInfinity : 0.0;
    const double sign = std::signbit(x) && isOdd(y) ? -1.0 : 1.0;
    if (size == 0.0 || std::isinf(size))
        return sign * ((size == 0.0) == (y > 0.0) ? 0.0 : kInfinity);
    if (x < 0.0 && !isInteger(y))
        return std::numeric_limits<double>::quiet_NaN();
    return sign * (size == 1.0 ? 1.0 : powerOfPositive(size, y));
}

double cbrt(double x) {
    if (x == 0.0 || !std::isfinite(x))
        return x;
    int binary = 0;
    const double fraction = std::frexp(std::abs(x), &binary);
    const int third = binary >= 0 ? binary / 3 : -((2 - binary) / 3); // rounded down
    const double a = std::ldexp(fraction, binary - 3 * third);        // 1/2 to 4
    // A third of the bits, exponent and fraction alike, is a cube root to 1 part in 32.
    const auto bits = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(a) >> 32U);
    double t = std::bit_cast<double>(static_cast<std::uint64_t>(bits / 3U + 715094163U) << 32U);
    const double r = (t * t) * (t / a);
    t *= (1.87595182427177009643 + r * (-1.88497979543377169875 + r * 1.621429720105354466140)) +
         (r * r * r) * (-0.758397934778766047437 + r * 0.145996192886612446982);
    // Rounded up to 23 bits: its square is exact.
    t = std::bit_cast<double>((std::bit_cast<std::uint64_t>(t) + 0x80000000U) & 0xffffffffc0000000U);
    const double q = a / (t * t);
    t += t * ((q - t) / ((t + t) + q));
    return std::copysign(std::ldexp(t, third), x);
}

double hypot(double x, double y) {
    x = std::abs(x);
    y = std::abs(y);
    if (std::isinf(x) || std::isinf(y))
        return kInfinity;
    if (std::isnan(x) || std::isnan(y))
        return std::numeric_limits<double>::quiet_NaN();
    if (x < y)
        std::swap(x, y);
    if (y <= 0x1p-54 * x)
        return x + y;
    const double scale = x > 0x1p500 ? 0x1p-700 : y < 0x1p-400 ? 0x1p600 : 1.0;
    const Wide xx = product(scale * x, scale * x), yy = product(scale * y, scale * y);
    const Wide head = sumOfOrdered(xx.hi, yy.hi);
    return std::sqrt(head.hi + (head.lo + (xx.lo + yy.lo))) / scale;
}

} // namespace supercircle::math
