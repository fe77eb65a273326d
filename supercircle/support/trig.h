#pragma once
// Inline sine and cosine, for code that needs thousands of them per step.
//
// Kernels: the minimax polynomials of fdlibm (Sun Microsystems 1993, k_sin.c and k_cos.c; truncation below 2^-58 for
// |x| <= pi/4). They use no tables, no data-dependent branches and no fused multiply-add, so results are bitwise
// identical on every machine (decision 0186). Larger angles are reduced by Cody and Waite's two-part pi/2, with the
// remainder in two words; huge angles and those near a multiple of pi/2 by a product with 224 bits of 2/pi. Errors,
// tested against long double: 1 unit in the last place.

#include <bit>
#include <cmath>
#include <cstdint>

namespace supercircle::math {

struct SinCos {
    double sine = 0.0;
    double cosine = 1.0;
};

namespace detail {

inline constexpr double kKernelBelow = 0.785; ///< |x| up to pi/4 for the kernels
inline constexpr double kReducible = 1e5;     ///< rad; the quotient by pi/2 stays far below 2^20

/// The two-part reduction errs by 7e-27 for each pi/2 that it takes away, and a remainder above this many times their
/// number is right to 2^-56. Half of it leaves errors of 0.1 units in the last place, twice of it costs nothing that
/// can be measured: one angle in 1e9 is nearer to a multiple.
inline constexpr double kNearMultiple = 5e-10;

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

/// Of x + tail, |x| <= pi/4 and |tail| below half a unit in its last place. The sine of -0 is +0.
inline SinCos kernel(double x, double tail) {
    const double z = x * x;
    const double halved = 0.5 * z;
    const double w = 1.0 - halved;
    return {x + (x * (z * sineKernel(z)) + tail * w),
            w + (((1.0 - w) - halved) + (z * z * cosineKernel(z) - x * tail))};
}

/// For `turns` of pi/2 from the kernel's.
inline SinCos turned(const SinCos& r, std::uint64_t turns) {
    const double table[4] = {r.sine, r.cosine, -r.sine, -r.cosine};
    return {table[turns & 3U], table[(turns + 1U) & 3U]};
}

/// An angle less the nearest multiple of pi/2: x + tail, and the multiple modulo 4.
struct Reduced {
    double x = 0.0;
    double tail = 0.0;
    std::uint64_t turns = 0;
};

/// Of any finite angle other than 0, by M. H. Payne and R. N. Hanek (SIGNUM Newsletter 18 (1983) 19).
[[gnu::const]] Reduced reduceExactly(double angle);
/// sinCos for the angles that the two-part reduction leaves: huge, near a multiple of pi/2, zero, not finite.
[[gnu::const]] SinCos sinCosExactly(double angle);

/// By the two-part pi/2; false: reduceExactly has to do it.
inline bool reduce(double angle, Reduced& out) {
    if (!(std::abs(angle) < kReducible))
        return false;
    constexpr double kRound = 0x1.8p52; // adding it leaves the nearest integer in the low bits
    const double shifted = angle * 6.36619772367581382433e-01 + kRound;
    const double n = shifted - kRound;
    const double rest = angle - n * 1.57079632673412561417e+00; // exact: pi/2 to 33 bits
    const double small = n * 6.07710050650619224932e-11;
    out.x = rest - small;
    out.tail = (rest - out.x) - small;
    out.turns = std::bit_cast<std::uint64_t>(shifted);
    return std::abs(out.x) > kNearMultiple * std::abs(n);
}

} // namespace detail

/// Sine and cosine of any angle, rad; NaN if it is not finite.
inline SinCos sinCos(double angle) {
    detail::Reduced r;
    if (!detail::reduce(angle, r))
        return detail::sinCosExactly(angle);
    return detail::turned(detail::kernel(r.x, r.tail), r.turns);
}

/// The same, cheaper for small angles; the sine of -0 is +0.
inline SinCos sinCosSmall(double angle) {
    return std::abs(angle) < detail::kKernelBelow ? detail::kernel(angle, 0.0) : sinCos(angle);
}

inline double sin(double angle) {
    return sinCos(angle).sine;
}

inline double cos(double angle) {
    return sinCos(angle).cosine;
}

/// sin(x)/x, full accuracy through x = 0.
inline double sinc(double x) {
    if (std::abs(x) < detail::kKernelBelow) {
        const double z = x * x;
        return 1.0 + z * detail::sineKernel(z);
    }
    return sin(x) / x;
}

} // namespace supercircle::math
