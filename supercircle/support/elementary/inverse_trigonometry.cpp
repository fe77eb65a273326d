// Inverse trigonometric functions. Reductions and polynomials are those of fdlibm (Sun Microsystems 1993, s_atan.c,
// e_asin.c, e_acos.c; truncation below 2^-58). The quotient y/x of atan2 keeps its remainder, and the reduction divides
// once, so that atan2 is as accurate as atan.

#include "supercircle/support/elementary.h"
#include "supercircle/support/elementary/wide.h"

#include <cmath>
#include <limits>

namespace supercircle::math {

namespace {

constexpr double kHalfPi = 1.57079632679489655800e+00, kHalfPiLow = 6.12323399573676603587e-17;
constexpr double kQuarterPi = 7.85398163397448278999e-01;

/// (t - atan(t))/t for |t| <= 7/16.
double arcTangentKernel(double t) {
    const double z = t * t, w = z * z;
    const double odd = 3.33333333333329318027e-01 +
                       w * (1.42857142725034663711e-01 +
                            w * (9.09088713343650656196e-02 +
                                 w * (6.66107313738753120669e-02 +
                                      w * (4.97687799461593236017e-02 + w * 1.62858201153657823623e-02))));
    const double even =
        -1.99999999998764832476e-01 +
        w * (-1.11111104054623557880e-01 +
             w * (-7.69187620504482999495e-02 + w * (-5.83357013379057348645e-02 + w * -3.65315727442169155270e-02)));
    return z * odd + w * even;
}

/// The angle of (x, y) in the first quadrant, x > 0 and y >= 0 finite, in two words.
Wide firstQuadrant(double y, double x) {
    if (y < 0x1p-28 * x)
        return {y / x, 0.0};
    if (x < 0x1p-60 * y)
        return {kHalfPi, kHalfPiLow};
    const double larger = x > y ? x : y;
    if (larger > 1e300 || larger < 1e-200) {
        const double scale = larger > 1.0 ? 0x1p-200 : 0x1p500;
        x *= scale;
        y *= scale;
    }
    if (y < 0.4375 * x) {
        const double t = y / x;
        const Wide back = product(t, x);
        const double remainder = ((y - back.hi) - back.lo) / x;
        return sumOfOrdered(t, remainder * (1.0 - t * t) - t * arcTangentKernel(t));
    }
    const auto beyond = [](double angle, double low, double t) {
        return sumOfOrdered(angle, (low - t * arcTangentKernel(t)) + t);
    };
    if (y < 0.6875 * x)
        return beyond(4.63647609000806093515e-01, 2.26987774529616870924e-17, (y - 0.5 * x) / (x + 0.5 * y));
    if (y < 1.1875 * x)
        return beyond(kQuarterPi, 0.5 * kHalfPiLow, (y - x) / (x + y));
    if (y < 2.4375 * x)
        return beyond(9.82793723247329054082e-01, 1.39033110312309984516e-17, ((y - x) - 0.5 * x) / (x + 1.5 * y));
    return beyond(kHalfPi, kHalfPiLow, -(x / y));
}

/// asin(x)/x - 1 for z = x^2 <= 1/4.
double arcSineKernel(double z) {
    const double p = z * (1.66666666666666657415e-01 +
                          z * (-3.25565818622400915405e-01 +
                               z * (2.01212532134862925881e-01 +
                                    z * (-4.00555345006794114027e-02 +
                                         z * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05)))));
    const double q =
        1.0 +
        z * (-2.40339491173441421878e+00 +
             z * (2.02094576023350569471e+00 + z * (-6.88283971605453293030e-01 + z * 7.70381505559019352791e-02)));
    return p / q;
}

/// 2 asin(sqrt(z)) for 0 < z <= 1/4, in two words: the angle whose cosine is 1 - 2 z.
Wide angleOfCosine(double z) {
    const double s = std::sqrt(z);
    const Wide square = product(s, s);
    const double rest = ((z - square.hi) - square.lo) / (2.0 * s); // sqrt(z) - s
    return sumOfOrdered(2.0 * s, 2.0 * (s * arcSineKernel(z) + rest));
}

/// pi/2 - a for a <= pi/2.
double fromHalfPi(const Wide& a) {
    const Wide d = sum(kHalfPi, -a.hi);
    return d.hi + (d.lo + (kHalfPiLow - a.lo));
}

} // namespace

double atan(double x) {
    if (std::isnan(x) || x == 0.0)
        return x;
    const double size = std::abs(x);
    const Wide a = std::isinf(x) ? Wide{kHalfPi, kHalfPiLow} : firstQuadrant(size, 1.0);
    return std::copysign(a.hi + a.lo, x);
}

double atan2(double y, double x) {
    if (std::isnan(x) || std::isnan(y))
        return std::numeric_limits<double>::quiet_NaN();
    double across = std::abs(y), along = std::abs(x);
    if (std::isinf(across) || std::isinf(along)) {
        along = std::isinf(along) ? 1.0 : 0.0;
        across = std::isinf(across) ? 1.0 : 0.0;
    }
    Wide a;
    if (along == 0.0 && across > 0.0)
        a = {kHalfPi, kHalfPiLow};
    else if (across > 0.0)
        a = firstQuadrant(across, along);
    if (!std::signbit(x))
        return std::copysign(a.hi + a.lo, y);
    const Wide d = sum(2.0 * kHalfPi, -a.hi);
    return std::copysign(d.hi + (d.lo + (2.0 * kHalfPiLow - a.lo)), y);
}

double asin(double x) {
    const double size = std::abs(x);
    if (!(size <= 1.0))
        return std::numeric_limits<double>::quiet_NaN();
    if (size < 0.5)
        return size < 0x1p-27 ? x : x + x * arcSineKernel(x * x);
    if (size == 1.0)
        return std::copysign(kHalfPi, x);
    return std::copysign(fromHalfPi(angleOfCosine(0.5 * (1.0 - size))), x);
}

double acos(double x) {
    const double size = std::abs(x);
    if (!(size <= 1.0))
        return std::numeric_limits<double>::quiet_NaN();
    if (size < 0.5)
        return fromHalfPi(sumOfOrdered(x, size < 0x1p-27 ? 0.0 : x * arcSineKernel(x * x)));
    if (size == 1.0)
        return x > 0.0 ? 0.0 : 2.0 * kHalfPi;
    const Wide a = angleOfCosine(0.5 * (1.0 - size));
    if (x > 0.0)
        return a.hi + a.lo;
    const Wide d = sum(2.0 * kHalfPi, -a.hi);
    return d.hi + (d.lo + (2.0 * kHalfPiLow - a.lo));
}

} // namespace supercircle::math
