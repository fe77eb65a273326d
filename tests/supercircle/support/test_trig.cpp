#include "supercircle/support/trig.h"

#include "ulps.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle::math;
using supercircle::test::ulps;

TEST_CASE("sine, cosine and sinc of small angles err by at most one unit in the last place", "[trig]") {
    double worst = 0.0;
    for (int i = 0; i < 300000; ++i) {
        const double x = 2e-6 * i + 1e-9 * (i % 7); // up to 0.6
        for (const SinCos& a : {sinCosSmall(x), sinCos(x)}) {
            worst = std::max(worst, ulps(a.sine, std::sin(static_cast<long double>(x))));
            worst = std::max(worst, ulps(a.cosine, std::cos(static_cast<long double>(x))));
        }
        if (x > 0.0)
            worst = std::max(worst, ulps(sinc(x), std::sin(static_cast<long double>(x)) / x));
    }
    CHECK(worst <= 1.0); // documented bound
    for (double x = 1e-300; x < 0.1; x *= 3.7) {
        CHECK(ulps(sinCos(x).sine, std::sin(static_cast<long double>(x))) <= 1.0);
        CHECK(sinCosSmall(-x).sine == -sinCosSmall(x).sine);
        CHECK(sinc(-x) == sinc(x));
    }
    CHECK(sinCos(0.0).sine == 0.0);
    CHECK(sinCos(0.0).cosine == 1.0);
    CHECK(sinc(0.0) == 1.0);
}

TEST_CASE("sine and cosine of any angle are right to 1.2e-16", "[trig]") {
    double worst = 0.0;
    const auto test = [&](double x) {
        const SinCos a = sinCos(x);
        const SinCos small = sinCosSmall(x);
        for (const SinCos& b : {a, small}) {
            worst = std::max(worst, std::abs(static_cast<double>(b.sine - std::sin(static_cast<long double>(x)))));
            worst = std::max(worst, std::abs(static_cast<double>(b.cosine - std::cos(static_cast<long double>(x)))));
        }
    };
    for (int i = -200000; i <= 200000; ++i)
        test(1.37e-4 * i);
    for (int i = -2000; i <= 2000; ++i) // beside the multiples of a quarter turn and between them
        for (const double d : {-1e-9, 0.0, 3e-17, 1e-12, M_PI_4})
            test(i * M_PI_2 + d);
    for (double x = 1.0; x < 1e12; x *= 1.0037) { // across the switch to all bits of pi
        test(x);
        test(-x);
    }
    CHECK(worst <= 1.2e-16); // documented bound: half a unit in the last place of 1 is 1.1e-16
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), static_cast<double>(INFINITY)}) {
        CHECK(std::isnan(sinCos(bad).sine));
        CHECK(std::isnan(sinCosSmall(bad).cosine));
        CHECK(std::isnan(sinc(bad)));
    }
}

TEST_CASE("sine and cosine stay relatively accurate where they vanish", "[trig]") {
    for (int i = 1; i < 3000; ++i) {
        const double x = i * M_PI_2; // off the true multiple by its rounding only
        const SinCos a = sinCos(x);
        const long double exact =
            i % 2 == 1 ? std::cos(static_cast<long double>(x)) : std::sin(static_cast<long double>(x));
        const double value = i % 2 == 1 ? a.cosine : a.sine;
        CHECK(ulps(value, exact) <= 1.0);
    }
}
