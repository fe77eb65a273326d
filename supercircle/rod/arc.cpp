// Closed forms of one arc. With x = k s / 2 and t, n the tangent and normal at the middle of the part:
//   chord    = s sinc(x) t
//   d/dk     = s^2/2 (sinc'(x) t + sinc(x) n)
//   centroid = start + s/2 (sinc(x) t + sinc'(x) n)
// sin(x)/x is accurate near zero. Its derivative and deficit suffer cancellation there and use their power series below
// |x| = 1.5. At that switch the direct formulas lose about two bits.

#include "supercircle/rod/arc.h"

#include "supercircle/support/trig.h"

#include <array>
#include <cstddef>

namespace supercircle::rod {

namespace {

constexpr double kSeriesBelow = 1.5;
constexpr std::size_t kTerms = 11; // the first dropped term is below 1e-18 of the first at |x| = 1.5

/// (-1)^n weight(n) / (2n+1)! for n = 1 .. kTerms, so that the sums below are polynomials in x^2.
template <class Weight>
constexpr std::array<double, kTerms> coefficients(Weight weight) {
    std::array<double, kTerms> c{};
    double factorial = 1.0;
    double sign = 1.0;
    for (std::size_t i = 0; i < kTerms; ++i) {
        const double n = static_cast<double>(i + 1);
        factorial *= 2.0 * n * (2.0 * n + 1.0);
        sign = -sign;
        c[i] = sign * weight(n) / factorial;
    }
    return c;
}

double horner(const std::array<double, kTerms>& c, double z, std::size_t terms) {
    double sum = 0.0;
    for (std::size_t i = terms; i-- > 0;)
        sum = sum * z + c[i];
    return sum;
}

/// Of the series above for |x| < kSeriesBelow; below 0.75 eight terms are exact to 1e-18 of the first.
double odd(const std::array<double, kTerms>& c, double x) {
    const double z = x * x;
    return x * (std::abs(x) < 0.75 ? horner(c, z, 8) : horner(c, z, kTerms));
}

} // namespace

double sincDerivative(double x) {
    static constexpr auto kSeries = coefficients([](double n) { return 2.0 * n; });
    if (std::abs(x) < kSeriesBelow)
        return odd(kSeries, x);
    return (math::cos(x) - math::sin(x) / x) / x;
}

double sincDeficit(double x) {
    static constexpr auto kSeries = coefficients([](double) { return -1.0; });
    if (std::abs(x) < kSeriesBelow)
        return odd(kSeries, x);
    return (1.0 - math::sin(x) / x) / x;
}

TurnFactors TurnFactors::ofLarge(double x) {
    if (std::abs(x) < kSeriesBelow)
        return series(x * x);
    const double h = math::sin(0.5 * x) / x;
    return {2.0 * h * h, (x - math::sin(x)) / (x * x * x)};
}

Vec2 Arc::chordCurvatureDerivative(double s) const {
    const double x = 0.5 * curvature * s;
    const Vec2 t = tangentAt(0.5 * s);
    return 0.5 * s * s * (sincDerivative(x) * t + math::sinc(x) * perp(t));
}

Vec2 Arc::centroid(double s) const {
    const double x = 0.5 * curvature * s;
    const Vec2 t = tangentAt(0.5 * s);
    return start + 0.5 * s * (math::sinc(x) * t + sincDerivative(x) * perp(t));
}

} // namespace supercircle::rod
