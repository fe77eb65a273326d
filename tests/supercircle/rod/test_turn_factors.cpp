#include "supercircle/rod/arc.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::rod;

TEST_CASE("turn factors are accurate on both sides of the switch and through zero", "[arc]") {
    CHECK(TurnFactors::of(0.0).versine == 0.5);
    CHECK(TurnFactors::of(0.0).deficit == Approx(1.0 / 6.0).epsilon(1e-16));
    for (double x = 1e-12; x < 12.0; x *= 1.02) {
        // Long double power series; below 12 its largest term is 1e4, so 1e-19 of it stays below 1e-15.
        long double versine = 0.0L, deficit = 0.0L, term = 0.5L; // term = (-1)^n x^2n / (2n+2)!
        for (int n = 0; n < 60; ++n) {
            versine += term;
            deficit += term / (2.0L * n + 3.0L);
            term *= -static_cast<long double>(x) * x / ((2.0L * n + 3.0L) * (2.0L * n + 4.0L));
        }
        INFO("x = " << x);
        const TurnFactors f = TurnFactors::of(x);
        // Two roundings; versine has a zero at 2 pi, so absolute beside values of at most 0.5.
        CHECK(std::abs(static_cast<double>(f.versine - versine)) <= 2.5e-16);
        CHECK(std::abs(static_cast<double>(f.deficit - deficit)) <= 1e-16);
        CHECK(TurnFactors::of(-x).versine == f.versine);
        CHECK(TurnFactors::of(-x).deficit == f.deficit);
    }
}

TEST_CASE("turn factors reproduce chord, centroid and curvature derivative of an arc", "[arc]") {
    for (const double k : {0.0, 1e-9, 0.3, -1.7, 1.8, 4.0, -9.0})
        for (const double s : {0.2, 1.0, -0.9}) {
            INFO("k = " << k << ", s = " << s);
            const Arc arc{Vec2(0.0, 0.0), 0.7, k, s};
            const double x = k * s;
            const TurnFactors f = TurnFactors::of(x);
            const Vec2 t = arc.tangentAt(0.0), n = perp(t);
            const double sine = 1.0 - x * x * f.deficit;
            CHECK((s * (sine * t + x * f.versine * n) - arc.chord(s)).norm() < 2e-15);
            CHECK((s * (f.versine * t + x * f.deficit * n) - arc.centroid(s)).norm() < 2e-15);
            CHECK((s * s * ((sine - f.versine) * n - x * (f.versine - f.deficit) * t) - arc.chordCurvatureDerivative(s))
                      .norm() < 2e-15);
        }
}
