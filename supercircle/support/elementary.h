#pragma once
// Elementary functions whose results are bitwise identical on every machine (decision 0186): those of C libraries
// differ in their last bits, with the library and with the processor. They use only operations that IEEE 754 rounds
// exactly.
//
// Ranges, special values and signs of zero are those of the C standard; the floating-point environment is not read and
// its flags mean nothing. Errors, tested against long double: below 1 unit in the last place (exp, log10, log2 and pow
// 0.76), below 2.5 for erfc, sinh and tanh. sin, cos and sinc: support/trig.h.

#include "supercircle/support/trig.h"

namespace supercircle::math {

/// Of an angle in rad.
[[gnu::const]] double tan(double angle);

/// In rad: asin and atan in [-pi/2, pi/2], acos in [0, pi], atan2 in [-pi, pi].
[[gnu::const]] double asin(double x);
[[gnu::const]] double acos(double x);
[[gnu::const]] double atan(double x);
[[gnu::const]] double atan2(double y, double x);

[[gnu::const]] double exp(double x);
/// exp(x) - 1
[[gnu::const]] double expm1(double x);
[[gnu::const]] double sinh(double x);
[[gnu::const]] double cosh(double x);
[[gnu::const]] double tanh(double x);

[[gnu::const]] double log(double x);
/// log(1 + x)
[[gnu::const]] double log1p(double x);
[[gnu::const]] double log10(double x);
[[gnu::const]] double log2(double x);

[[gnu::const]] double pow(double x, double y);
[[gnu::const]] double cbrt(double x);
/// sqrt(x^2 + y^2) without overflow on the way.
[[gnu::const]] double hypot(double x, double y);

/// 1 - erf(x)
[[gnu::const]] double erfc(double x);

} // namespace supercircle::math
