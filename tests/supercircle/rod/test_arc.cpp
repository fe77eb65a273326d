#include "supercircle/rod/arc.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::rod;
namespace math = supercircle::math;

namespace {

struct LongVec {
    long double x = 0.0L;
    long double y = 0.0L;
};

/// Composite 10-point Gauss-Legendre in long double of weight(sigma) * tangent(sigma) over [0, s].
template <class Weight>
LongVec integrateTangent(const Arc& arc, double s, Weight weight) {
    static const long double kNode[5] = {0.1488743389816312108848L, 0.4333953941292471907993L,
                                         0.6794095682990244062343L, 0.8650633666889845107321L,
                                         0.9739065285171717200780L};
    static const long double kWeight[5] = {0.2955242247147528701739L, 0.2692667193099963550912L,
                                           0.2190863625159820439955L, 0.1494513491505805931458L,
                                           0.0666713443086881375936L};
    const int panels = 64; // the widest panel turns 0.5 rad: the rule's error is far below 1e-18 there
    const long double half = static_cast<long double>(s) / (2.0L * panels);
    LongVec sum;
    for (int p = 0; p < panels; ++p) {
        for (int i = 0; i < 10; ++i) {
            const long double u = (i % 2 == 0 ? 1.0L : -1.0L) * kNode[i / 2];
            const long double sigma = half * (2.0L * p + 1.0L + u);
            const long double angle = static_cast<long double>(arc.angle) + arc.curvature * sigma;
            const long double w = half * kWeight[i / 2] * weight(sigma);
            sum.x += w * std::cos(angle);
            sum.y += w * std::sin(angle);
        }
    }
    return sum;
}

void requireClose(const Vec2& value, const LongVec& reference, double scale) {
    // A few roundings of numbers of this scale; the angle's own rounding (|angle| eps) enters too.
    CHECK(std::abs(static_cast<double>(value.x() - reference.x)) <= 1e-15 * scale);
    CHECK(std::abs(static_cast<double>(value.y() - reference.y)) <= 1e-15 * scale);
}

const double kCurvatures[] = {0.0, 1e-300, 1e-12, -1e-8, 1e-5, 1e-3, -0.1, 1.0, 2.9, -3.1, 6.0, 7.5, -20.0};
const double kLengths[] = {1e-6, 0.3, 1.0, 1.6, -0.4, -1.3};

} // namespace

TEST_CASE("sinc and its relatives have full relative accuracy through zero", "[arc]") {
    CHECK(math::sinc(0.0) == 1.0);
    CHECK(sincDerivative(0.0) == 0.0);
    CHECK(sincDeficit(0.0) == 0.0);
    for (double x = 1e-9; x < 3.0; x *= 1.07) {
        // References by the full power series in long double: no cancellation below 3.
        long double value = 0.0L;
        long double slope = 0.0L;
        long double deficit = 0.0L;
        long double term = 1.0L; // (-1)^n x^2n / (2n+1)!
        for (int n = 0; n < 30; ++n) {
            value += term;
            slope += term * (2.0L * n) / x;
            if (n > 0)
                deficit -= term / x;
            term *= -static_cast<long double>(x) * x / ((2.0L * n + 2.0L) * (2.0L * n + 3.0L));
        }
        INFO("x = " << x);
        // Values are O(x) or O(1): relative 2 ulp below 1.5, absolute 1e-15 beyond where zeros may be near.
        CHECK(std::abs(static_cast<double>(math::sinc(x) - value)) <= 4e-16);
        CHECK(std::abs(static_cast<double>(sincDerivative(x) - slope)) <= 1e-15 * std::abs(static_cast<double>(slope)));
        CHECK(std::abs(static_cast<double>(sincDeficit(x) - deficit)) <=
              1e-15 * std::abs(static_cast<double>(deficit)));
        CHECK(math::sinc(-x) == math::sinc(x));
        CHECK(sincDerivative(-x) == -sincDerivative(x));
        CHECK(sincDeficit(-x) == -sincDeficit(x));
    }
    for (double x = 3.0; x < 60.0; x += 0.37) { // large arguments against the direct formulas in long double
        const long double lx = x;
        CHECK(math::sinc(x) == Approx(static_cast<double>(std::sin(lx) / lx)).margin(1e-15));
        CHECK(sincDerivative(x) == Approx(static_cast<double>((std::cos(lx) - std::sin(lx) / lx) / lx)).margin(1e-15));
        CHECK(sincDeficit(x) == Approx(static_cast<double>((1.0L - std::sin(lx) / lx) / lx)).margin(1e-15));
    }
}

TEST_CASE("points, curvature derivatives and centroids of arcs equal quadrature", "[arc]") {
    for (const double k : kCurvatures) {
        for (const double s : kLengths) { // k s reaches 32 rad: curled five times over
            const Arc arc{Vec2(0.25, -0.5), 0.7, k, 2.0};
            INFO("k = " << k << ", s = " << s);
            const double turn = 1.0 + std::abs(k * s);
            const double l = std::abs(s);
            requireClose(arc.chord(s), integrateTangent(arc, s, [](long double) { return 1.0L; }), l * turn);
            // centroid - start = integral of (1 - sigma/s) t
            requireClose(arc.centroid(s) - arc.start,
                         integrateTangent(arc, s, [s](long double sigma) { return 1.0L - sigma / s; }), l * turn + 1.0);
            // d chord / dk = integral of sigma n = perp of integral of sigma t
            const LongVec m = integrateTangent(arc, s, [](long double sigma) { return sigma; });
            requireClose(arc.chordCurvatureDerivative(s), LongVec{-m.y, m.x}, l * l * turn);
        }
    }
}

TEST_CASE("the curvature derivative equals finite differences", "[arc]") {
    for (const double k : kCurvatures) {
        for (const double s : kLengths) {
            const double e = 1e-5;
            const Arc plus{Vec2(0.1, 0.2), -2.0, k + e, 1.0};
            const Arc minus{Vec2(0.1, 0.2), -2.0, k - e, 1.0};
            const Arc arc{Vec2(0.1, 0.2), -2.0, k, 1.0};
            const Vec2 fd = (plus.pointAt(s) - minus.pointAt(s)) / (2.0 * e);
            // Central difference: e^2 s^4/24 plus rounding 1e-16/e.
            CHECK((fd - arc.chordCurvatureDerivative(s)).norm() < 1e-9);
        }
    }
}

TEST_CASE("arcs are continued and split without a seam", "[arc]") {
    for (const double k : kCurvatures) {
        const Arc arc{Vec2(-1.0, 3.0), 2.5, k, 1.0};
        const Arc rest{arc.pointAt(0.4), arc.angleAt(0.4), k, 0.6};
        const double tolerance = 1e-15 * (4.0 + std::abs(k) * 4.0);
        CHECK((arc.pointAt(1.0) - rest.pointAt(0.6)).norm() < tolerance);
        CHECK((arc.pointAt(-0.3) - rest.pointAt(-0.7)).norm() < tolerance);
        CHECK((arc.tangentAt(0.9) - rest.tangentAt(0.5)).norm() < tolerance);
        CHECK(arc.tangentAt(0.37).norm() == Approx(1.0).epsilon(1e-15));
        if (std::abs(k) > 1e-3) { // every point at distance 1/|k| from the centre
            const Vec2 centre = arc.start + perp(arc.tangentAt(0.0)) / k;
            CHECK((arc.pointAt(0.8) - centre).norm() * std::abs(k) == Approx(1.0).epsilon(1e-12));
        }
    }
    const Arc straight{Vec2(1.0, 1.0), 0.0, 0.0, 2.0};
    CHECK(straight.pointAt(2.0).x() == 3.0);
    CHECK(straight.pointAt(-2.0).x() == -1.0);
    CHECK(straight.centroid(2.0).x() == 2.0);
}
