// exp, expm1 and hyperbolic functions. Reduction and rational function are those of fdlibm (Sun Microsystems 1993,
// s_expm1.c; truncation below 2^-61); 1 + r is summed in two words.

#include "supercircle/support/elementary/exponential.h"

#include "supercircle/support/elementary.h"

#include <cmath>
#include <limits>

namespace supercircle::math {

namespace {

constexpr double kPerLog2 = 1.44269504088896338700e+00;

/// x = n log 2 + (r.hi + r.lo)
struct Split {
    double n = 0.0;
    Wide r;
};

Split split(const Wide& x) {
    constexpr double kRound = 0x1.8p52; // adding it and taking it away rounds to an integer
    const double n = (x.hi * kPerLog2 + kRound) - kRound;
    const Wide high = sum(x.hi - n * kLog2, -(n * kLog2Low));
    return {n, sumOfOrdered(high.hi, high.lo + x.lo)};
}

/// exp(r) - 1 - r for |r| <= log(2)/2.
double curvedPart(double r) {
    const double half = 0.5 * r, z = r * half;
    const double r1 = 1.0 + z * (-3.33333333333331316428e-02 +
                                 z * (1.58730158725481460165e-03 +
                                      z * (-7.93650757867487942473e-05 +
                                           z * (4.00821782732936239552e-06 + z * -2.01099218183624371326e-07))));
    const double t = 3.0 - r1 * half;
    return z - r * (z * ((r1 - t) / (6.0 - r * t)));
}

} // namespace

Scaled wideExponential(const Wide& x) {
    const auto [n, r] = split(x);
    const Wide s = sumOfOrdered(1.0, r.hi);
    return {sumOfOrdered(s.hi, s.lo + (curvedPart(r.hi) + (r.lo + r.hi * r.lo))), static_cast<int>(n)};
}

double exponential(const Wide& x) {
    const Scaled e = wideExponential(x);
    return std::ldexp(e.mantissa.hi + e.mantissa.lo, e.binary);
}

double exp(double x) {
    if (std::isnan(x))
        return x;
    if (x > 710.0)
        return std::numeric_limits<double>::infinity();
    if (x < -746.0)
        return 0.0;
    return exponential({x, 0.0});
}

double expm1(double x) {
    if (std::isnan(x) || x == 0.0)
        return x;
    if (x > 710.0)
        return std::numeric_limits<double>::infinity();
    if (x < -38.0)
        return -1.0;
    const double size = std::abs(x);
    if (size < 0x1p-54)
        return x;
    if (size < 0.5 * kLog2)
        return x + curvedPart(x);
    const auto [n, r] = split({x, 0.0}); // 2^n (exp(r) - 2^-n)
    const int binary = static_cast<int>(n);
    const Wide start = sum(1.0, -std::ldexp(1.0, -binary)), s = sum(start.hi, r.hi);
    return std::ldexp(s.hi + (s.lo + (curvedPart(r.hi) + (start.lo + r.lo + r.hi * r.lo))), binary);
}

double sinh(double x) {
    const double size = std::abs(x);
    if (!(size < 711.0) || x == 0.0)
        return std::isnan(x) || x == 0.0 ? x : std::copysign(std::numeric_limits<double>::infinity(), x);
    if (size < 1.0) {
        const double t = expm1(size);
        return std::copysign(0.5 * (t + t / (t + 1.0)), x);
    }
    const Scaled e = wideExponential({size, 0.0});
    const double back = size < 25.0 ? std::ldexp(1.0 / e.mantissa.hi, -2 * e.binary) : 0.0;
    return std::copysign(std::ldexp(e.mantissa.hi + (e.mantissa.lo - back), e.binary - 1), x);
}

double cosh(double x) {
    const double size = std::abs(x);
    if (!(size < 711.0))
        return std::isnan(x) ? x : std::numeric_limits<double>::infinity();
    const Scaled e = wideExponential({size, 0.0});
    const double back = size < 25.0 ? std::ldexp(1.0 / e.mantissa.hi, -2 * e.binary) : 0.0;
    return std::ldexp(e.mantissa.hi + (e.mantissa.lo + back), e.binary - 1);
}

double tanh(double x) {
    const double size = std::abs(x);
    if (std::isnan(x) || x == 0.0)
        return x;
    if (size > 22.0)
        return std::copysign(1.0, x);
    const double t = size < 1.0 ? -expm1(-2.0 * size) : expm1(2.0 * size);
    return std::copysign(size < 1.0 ? t / (2.0 - t) : 1.0 - 2.0 / (t + 2.0), x);
}

} // namespace supercircle::math
