#pragma once
// A circular arc element in closed form, one code path for straight, curved and nearly straight elements.

#include "supercircle/support/trig.h"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

#ifndef EIGEN_DONT_VECTORIZE // the libraries are built with it: sums in another order, types of another alignment
#error "EIGEN_DONT_VECTORIZE must be defined; linking supercircle::supercircle does it"
#endif

namespace supercircle::rod {

using Vec2 = Eigen::Vector2d;

/// Counter-clockwise quarter turn.
inline Vec2 perp(const Vec2& a) {
    return {-a.y(), a.x()};
}
/// z component of the cross product.
inline double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// d/dx (sin(x)/x), full accuracy through x = 0.
double sincDerivative(double x);
/// (1 - sin(x)/x)/x, odd, full accuracy through x = 0.
double sincDeficit(double x);

namespace detail {
using TurnSeries = std::array<double, 11>;
/// (-1)^i / (2 i + first)! for first = 2 or 3.
constexpr TurnSeries turnSeries(int first) {
    TurnSeries c{};
    double term = first == 2 ? 0.5 : 1.0 / 6.0;
    for (std::size_t i = 0; i < c.size(); ++i) {
        c[i] = term;
        const double n = 2.0 * static_cast<double>(i) + first;
        term /= -(n + 1.0) * (n + 2.0);
    }
    return c;
}
inline constexpr TurnSeries kVersine = turnSeries(2);
inline constexpr TurnSeries kDeficit = turnSeries(3);
/// The first `Terms` terms.
template <std::size_t Terms>
constexpr double horner(const TurnSeries& c, double z) {
    double sum = c[Terms - 1];
    for (std::size_t i = Terms - 1; i-- > 0;)
        sum = sum * z + c[i];
    return sum;
}
} // namespace detail

/// The two even functions to which every integral along an arc reduces; x is the rotation of the tangent, rad:
///     versine = (1 - cos x)/x^2      deficit = (x - sin x)/x^3
/// In the frame (t, n) of the arc's start, a part of length s has, with x = k s,
///     sin x / x                = 1 - x^2 deficit
///     end - start              = s   [(1 - x^2 deficit) t + x versine n]
///     centroid - start         = s   [versine t + x deficit n]
///     d (end - start)/dk       = s^2 [-x (versine - deficit) t + (1 - x^2 deficit - versine) n]
/// without cancellation at any x.
struct TurnFactors {
    /// Below this |x| the power series is exact to round-off and much cheaper than sines.
    static constexpr double kSeriesBelow = 1.75;
    /// Below this |x| eight terms suffice. The elements of a finely divided rod lie here.
    static constexpr double kShortBelow = 0.75;

    double versine = 0.5;
    double deficit = 1.0 / 6.0;

    /// For |x| < kSeriesBelow, z = x^2 (the first dropped terms are below 2e-18).
    static TurnFactors series(double z) {
        return {detail::horner<11>(detail::kVersine, z), detail::horner<11>(detail::kDeficit, z)};
    }
    /// For |x| < kShortBelow (the first dropped terms are below 2e-18, too).
    static TurnFactors shortSeries(double z) {
        return {detail::horner<8>(detail::kVersine, z), detail::horner<8>(detail::kDeficit, z)};
    }
    /// Full accuracy for any x.
    static TurnFactors of(double x) { return std::abs(x) < kShortBelow ? shortSeries(x * x) : ofLarge(x); }

private:
    static TurnFactors ofLarge(double x);
};

/// An oriented arc: starts at `start` with tangent angle `angle`, runs along signed arc length up to `length` with
/// constant curvature. Angles in rad, lengths in m, curvature in 1/m (positive turns the tangent counter-clockwise).
struct Arc {
    Vec2 start = Vec2::Zero();
    double angle = 0.0;
    double curvature = 0.0;
    double length = 0.0;

    /// Tangent angle at arc length s.
    [[nodiscard]] double angleAt(double s) const { return angle + curvature * s; }
    /// Unit tangent at arc length s.
    [[nodiscard]] Vec2 tangentAt(double s) const {
        const math::SinCos a = math::sinCos(angleAt(s));
        return {a.cosine, a.sine};
    }
    /// Point at arc length s (any sign; the arc is continued beyond its ends).
    [[nodiscard]] Vec2 pointAt(double s) const { return start + chord(s); }
    /// pointAt(s) - start = s sinc(k s/2) t(angle + k s/2).
    [[nodiscard]] Vec2 chord(double s) const {
        const double x = 0.5 * curvature * s;
        const double c = s * math::sinc(x);
        const math::SinCos a = math::sinCos(angle + x);
        return {c * a.cosine, c * a.sine};
    }
    /// d pointAt(s) / d curvature at fixed start and angle.
    [[nodiscard]] Vec2 chordCurvatureDerivative(double s) const;
    /// Centroid of the part [0, s].
    [[nodiscard]] Vec2 centroid(double s) const;
};

} // namespace supercircle::rod
