#pragma once
// What powers share with exponentials and logarithms.

#include "supercircle/support/elementary/wide.h"

namespace supercircle::math {

inline constexpr double kLog2 = 6.93147180369123816490e-01;    ///< to 33 bits: its multiples by an exponent are exact
inline constexpr double kLog2Low = 1.90821492927058770002e-10; ///< what is left of log 2

/// 2^binary (hi + lo)
struct Scaled {
    Wide mantissa;
    int binary = 0;
};

/// exp(x) for |x| < 1100; relative error below 2^-56.
Scaled wideExponential(const Wide& x);
double exponential(const Wide& x);

/// log(x) of a positive finite x in two words; relative error below 2^-64.
Wide wideLogarithm(double x);

} // namespace supercircle::math
