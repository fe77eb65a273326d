// Reduction of angles by the bits of 2/pi, and the tangent. Sources: support/trig.h; the tangent's polynomial is that
// of fdlibm (Sun Microsystems 1993, k_tan.c; truncation below 2^-59).

#include "supercircle/support/elementary.h"
#include "supercircle/support/elementary/wide.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace supercircle::math {

namespace {

/// Words of 2/pi that are multiplied: 53 bits of the angle, 61 of cancellation, 106 are left.
constexpr std::size_t kWords = 7;

/// 2/pi in words of 32 bits after 64 bits of zeros.
constexpr std::array<std::uint32_t, 41> kTwoOverPi = {
    0x00000000, 0x00000000, 0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab,
    0xdebbc561, 0xb7246e3a, 0x424dd2e0, 0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484,
    0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4, 0x9c845f8b, 0xbdf9283b, 0x1ff897ff, 0xde05980f, 0xef2f118b,
    0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d, 0x7527bac7, 0xebe5f17b, 0x3d0739f7, 0x8a5292ea,
    0x6bfb5fb1, 0x1f8d5d08, 0x56033046, 0xfc7b6bab, 0xf0cfbc20};

/// The integer a of 53 bits times the integer in the kWords words of 2/pi from `first` on; the lowest word first.
std::array<std::uint32_t, kWords + 2> timesTwoOverPi(std::uint64_t a, std::size_t first) {
    std::array<std::uint32_t, kWords + 2> out{};
    const std::array<std::uint64_t, 2> factor = {a & 0xffffffffU, a >> 32U};
    for (std::size_t j = 0; j < factor.size(); ++j) {
        std::uint64_t carry = 0;
        for (std::size_t i = 0; i < kWords; ++i) {
            carry += factor[j] * kTwoOverPi[first + kWords - 1 - i] + out[i + j];
            out[i + j] = static_cast<std::uint32_t>(carry);
            carry >>= 32U;
        }
        out[kWords + j] = static_cast<std::uint32_t>(carry);
    }
    return out;
}

/// pi/2 times a fraction given by its first 192 bits, the highest word first.
Wide timesHalfPi(std::array<std::uint64_t, 3> words) {
    int exponent = 0;
    while (words[0] == 0 && exponent > -128) {
        words = {words[1], words[2], 0};
        exponent -= 64;
    }
    const int zeros = std::countl_zero(words[0]);
    if (zeros > 0 && zeros < 64) {
        words[0] = (words[0] << zeros) | (words[1] >> (64 - zeros));
        words[1] = (words[1] << zeros) | (words[2] >> (64 - zeros));
    }
    const double hi = static_cast<double>(words[0] >> 11U);
    const double lo = static_cast<double>(((words[0] & 0x7ffU) << 42U) | (words[1] >> 22U));
    const Wide x =
        sumOfOrdered(hi * 0x1p-53, lo * 0x1p-106) * Wide{1.57079632679489655800e+00, 6.12323399573676603587e-17};
    return {std::ldexp(x.hi, exponent - zeros), std::ldexp(x.lo, exponent - zeros)};
}

/// (tan(x) - x - x^3/3)/x^5 for z = x^2.
double tangentKernel(double z) {
    const double w = z * z;
    const double even = 1.33333333333201242699e-01 +
                        w * (2.18694882948595424599e-02 +
                             w * (3.59207910759131235356e-03 +
                                  w * (5.88041240820264096874e-04 +
                                       w * (7.81794442939557092300e-05 + w * -1.85586374855275456654e-05))));
    const double odd = 5.39682539762260521377e-02 +
                       w * (8.86323982359930005737e-03 +
                            w * (1.45620945432529025516e-03 +
                                 w * (2.46463134818469906812e-04 +
                                      w * (7.14072491382608190305e-05 + w * 2.59073051863633712884e-05))));
    return even + z * odd;
}

/// Tangent of x + tail for |x| <= pi/4, in two words.
Wide tangent(double x, double tail) {
    const double z = x * x, cube = z * x;
    const double rest = tail + z * (cube * tangentKernel(z) + tail) + 3.33333333333334091986e-01 * cube;
    return sumOfOrdered(x, rest);
}

/// The same for pi/4 - 0.12 < |x| <= pi/4, by tan(pi/4 - u) = (1 - tan u)/(1 + tan u).
Wide tangentOfLarge(double x, double tail) {
    const double sign = x < 0.0 ? -1.0 : 1.0;
    const Wide u = sum(7.85398163397448278999e-01 - sign * x, 3.06161699786838301793e-17 - sign * tail);
    const Wide t = tangent(u.hi, u.lo);
    const Wide q = (Wide{1.0, 0.0} + Wide{-t.hi, -t.lo}) / (Wide{1.0, 0.0} + t);
    return {sign * q.hi, sign * q.lo};
}

} // namespace

namespace detail {

Reduced reduceExactly(double angle) {
    int binary = 0;
    const double fraction = std::frexp(std::abs(angle), &binary);
    const auto integer = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    const int exponent = binary - 53; // |angle| = integer 2^exponent
    if (exponent < -62)               // far below pi/4
        return {angle, 0.0, 0};
    // Bits of 2/pi that give multiples of 4 are left out: those before word `first`.
    const auto first = static_cast<std::size_t>(exponent + 62) / 32U;
    const auto words = timesTwoOverPi(integer, first);
    // The ones of the product stand at bit 32 first + 160 - exponent, 191 to 222; they are brought to bit 224 of eight.
    const auto shift = static_cast<unsigned>(224 - (32 * static_cast<int>(first) + 160 - exponent)); // 2 to 33
    const auto at = [&](std::size_t i) -> std::uint64_t { return i < words.size() ? words[i] : 0U; };
    std::array<std::uint64_t, 8> bits{}; // 32 each, the lowest first; bits[7] holds the ones
    for (std::size_t i = 0; i < bits.size(); ++i) {
        const std::size_t whole = shift / 32U;
        const unsigned part = shift % 32U;
        const std::uint64_t own = i >= whole ? at(i - whole) : 0U, below = i >= whole + 1 ? at(i - whole - 1) : 0U;
        bits[i] = (((own << 32U) | below) >> (32U - part)) & 0xffffffffU;
    }
    std::array<std::uint64_t, 3> f = {(bits[6] << 32U) | bits[5], (bits[4] << 32U) | bits[3],
                                      (bits[2] << 32U) | bits[1]};
    std::uint64_t turns = bits[7] & 3U;
    const bool above = (f[0] >> 63U) != 0; // a half: the next multiple is nearer
    if (above) {
        ++turns;
        for (std::uint64_t& word : f)
            word = ~word; // short of the negative by 2^-192
    }
    const Wide x = timesHalfPi(f);
    const double sign = above != (angle < 0.0) ? -1.0 : 1.0;
    return {sign * x.hi, sign * x.lo, angle < 0.0 ? 4U - turns : turns};
}

SinCos sinCosExactly(double angle) {
    if (angle == 0.0)
        return {angle, 1.0};
    if (!std::isfinite(angle))
        return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    const Reduced r = reduceExactly(angle);
    return turned(kernel(r.x, r.tail), r.turns);
}

} // namespace detail

double tan(double angle) {
    if (angle == 0.0)
        return angle;
    if (!std::isfinite(angle))
        return std::numeric_limits<double>::quiet_NaN();
    detail::Reduced r;
    if (!detail::reduce(angle, r))
        r = detail::reduceExactly(angle);
    const Wide t = std::abs(r.x) < 0.6744 ? tangent(r.x, r.tail) : tangentOfLarge(r.x, r.tail);
    if ((r.turns & 1U) == 0)
        return t.hi + t.lo;
    const Wide q = Wide{-1.0, 0.0} / t;
    return q.hi + q.lo;
}

} // namespace supercircle::math
