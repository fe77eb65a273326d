#pragma once
// Inline sine and cosine, for code that needs thousands of them per step.
//
// Kernels: the minimax polynomials of fdlibm (Sun Microsystems 1993, k_sin.c and k_cos.c; truncation below 2^-58 for
// |x| <= pi/4). They use no tables, no data-dependent branches and no fused multiply-add, so results are bitwise
// identical on every machine; libm selects a variant by processor. Larger angles are reduced by Cody and Waite's
// two-part pi/2, with the remainder in two words. Beyond kReducible, and for non-finite arguments, libm is called.
// Errors, tested against long double: 1 unit in the last place for sinc and for |x| <= 0.6; 1.2e-16 absolute elsewhere.

#include <bit>
#include <cmath>
#include <cstdint>

namespace supercircle::rod {

struct SinCos {
    double sine = 0.0;
    double cosine = 1.0;
};

namespace detail {

inline constexpr double kKernelBelow = 0.785; ///< |x| up to pi/4 for the kernels
inline constexpr double kReducible = 1e5;     ///< rad; the quotient by pi/2 stays far below 2^20

/// (sin(x)/x - 1)/x^2 for z = x^2.
inline double sineKernel(double z) {
    const double w = z * z;
    const double low = -1.66666666666666324348e-01 + z * 8.33333333332248946124e-03;
    const double middle = -1.98412698298579493134e-04 + z * 2.75573137070700676789e-06;
    const double high = -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10;
    return low + w * (middle + w * high);
}

/// (cos x - 1 + x^2/2)/x^4 for z = x^2.
inline double cosineKernel(double z) {
    const double w = z * z;
    const double low = 4.16666666666666019037e-02 + z * -1.38888888888741095749e-03;
    const double middle = 2.48015872894767294178e-05 + z * -2.75573143513906633035e-07;
    const double high = 2.08757232129817482790e-09 + z * -1.13596475577881948265e-11;
    return low + w * (middle + w * high);
}

/// Of x + tail, |x| <= pi/4 and |tail| below half a unit in its last place.
inline SinCos kernel(double x, double tail) {
    const double z = x * x;
    const double halved = 0.5 * z;
    const double w = 1.0 - halved;
    return {x + (x * (z * sineKernel(z)) + tail * w),
            w + (((1.0 - w) - halved) + (z * z * cosineKernel(z) - x * tail))};
}

} // namespace detail

/// Sine and cosine of any angle, rad.
inline SinCos sinCos(double angle) {
    if (!(std::abs(angle) < detail::kReducible))
        return {std::sin(angle), std::cos(angle)};
    constexpr double kRound = 0x1.8p52; // adding it leaves the nearest integer in the low bits
    const double shifted = angle * 6.36619772367581382433e-01 + kRound;
    const double n = shifted - kRound;
    const double rest = angle - n * 1.57079632673412561417e+00; // exact: pi/2 to 33 bits
    const double small = n * 6.07710050650619224932e-11;
    const double x = rest - small;
    const SinCos r = detail::kernel(x, (rest - x) - small);
    const double turned[4] = {r.sine, r.cosine, -r.sine, -r.cosine};
    const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
    return {turned[quadrant & 3U], turned[(quadrant + 1U) & 3U]};
}

/// The same, cheaper for small angles.
inline SinCos sinCosSmall(double angle) {
    return std::abs(angle) < detail::kKernelBelow ? detail::kernel(angle, 0.0) : sinCos(angle);
}

/// sin(x)/x, full accuracy through x = 0.
inline double sinc(double x) {
    if (std::abs(x) < detail::kKernelBelow) {
        const double z = x * x;
        return 1.0 + z * detail::sineKernel(z);
    }
    return std::sin(x) / x;
}

} // namespace supercircle::rod
