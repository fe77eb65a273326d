// Logarithms. log and log1p follow fdlibm (Sun Microsystems 1993, e_log.c, s_log1p.c; truncation below 2^-58). The one
// in two words has the series in s = (m - b)/(m + b), b = 1 or 3/2, with the coefficients of fdlibm's e_pow.c.

#include "supercircle/support/elementary.h"
#include "supercircle/support/elementary/exponential.h"
#include "supercircle/support/elementary/wide.h"

#include <cmath>
#include <limits>

namespace supercircle::math {

namespace {

constexpr double kSqrtHalf = 0.70710678118654752440;

/// n log 2 + log(1 + f) + small for 1 + f from sqrt(1/2) to sqrt(2) and |small| far below f or n.
double logarithm(double n, double f, double small) {
    const double square = 0.5 * f * f;
    const double s = f / (2.0 + f), z = s * s, w = z * z;
    const double even = w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const double odd =
        z * (6.666666666666735130e-01 +
             w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    const Wide head = sum(n * kLog2, f);
    return head.hi + (head.lo - (square - (s * (square + (even + odd)) + (n * kLog2Low + small))));
}

/// x = m 2^n with m from sqrt(1/2) to sqrt(2).
double mantissa(double x, int& n) {
    const double m = std::frexp(x, &n);
    if (m >= kSqrtHalf)
        return m;
    --n;
    return 2.0 * m;
}

/// True if `out` is the logarithm already: of zero, negative, infinite numbers and NaN.
bool special(double x, double& out) {
    if (x > 0.0 && x < kInfinity)
        return false;
    out = x == 0.0 ? -kInfinity : x > 0.0 ? x : std::numeric_limits<double>::quiet_NaN();
    return true;
}

} // namespace

Wide wideLogarithm(double x) {
    int n = 0;
    double m = 2.0 * std::frexp(x, &n); // 1 to 2
    --n;
    const bool middle = m >= 1.2247448713915890491 && m < 1.7320508075688772935; // sqrt(3/2) to sqrt(3)
    if (m >= 1.7320508075688772935) {
        m *= 0.5;
        ++n;
    }
    const double b = middle ? 1.5 : 1.0;
    const Wide s = Wide{m - b, 0.0} / sum(m, b);
    const Wide z = s * s;
    const double w = z.hi;
    const double series = w * (5.99999999999994648725e-01 +
                               w * (4.28571428578550184252e-01 +
                                    w * (3.33333329818377432918e-01 +
                                         w * (2.72728123808534006489e-01 +
                                              w * (2.30660745775561754067e-01 + w * 2.06975017800338417784e-01)))));
    // log(m/b) = 2 s (1 + z/3 (1 + series))
    const Wide third = Wide{z.hi, z.lo + z.hi * series} * Wide{0x1.5555555555555p-2, 0x1.5555555555555p-56};
    const Wide part = Wide{2.0 * s.hi, 2.0 * s.lo} * (Wide{1.0, 0.0} + third);
    const Wide base = middle ? Wide{0x1.9f323ecbf984cp-2, -0x1.a92e513217f5cp-59} : Wide{};
    return sum(n * kLog2, n * kLog2Low) + (base + part);
}

namespace {

double multipleOfLogarithm(double x, const Wide& factor) {
    double out = 0.0;
    if (special(x, out))
        return out;
    const Wide l = wideLogarithm(x) * factor;
    return l.hi + l.lo;
}

} // namespace

double log(double x) {
    double out = 0.0;
    if (special(x, out))
        return out;
    int n = 0;
    const double f = mantissa(x, n) - 1.0;
    return logarithm(n, f, 0.0);
}

double log1p(double x) {
    double out = 0.0;
    if (x == 0.0 || special(1.0 + x, out))
        return x == 0.0 ? x : out;
    if (std::abs(x) < 0x1p-54)
        return x;
    if (x > -0.2928 && x < 0.4142)
        return logarithm(0.0, x, 0.0);
    const Wide u = sum(1.0, x);
    int n = 0;
    const double f = mantissa(u.hi, n) - 1.0;
    return logarithm(n, f, u.lo / u.hi);
}

double log10(double x) {
    return multipleOfLogarithm(x, {0x1.bcb7b1526e50ep-2, 0x1.95355baaafad3p-57}); // 1/log(10)
}

double log2(double x) {
    return multipleOfLogarithm(x, {0x1.71547652b82fep+0, 0x1.777d0ffda0d24p-56}); // 1/log(2)
}

} // namespace supercircle::math
