// Reading force-displacement curves: synthetic ones with known answers.

#include "plugin/lab/session/force_curve.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::lab;

TEST_CASE("work is the area under the curve", "[lab]") {
    std::vector<double> x, f;
    CHECK(workOf(x, f) == 0.0);
    const int n = 200;
    for (int i = 0; i <= n; ++i) { // there along F = x^2 ...
        x.push_back(0.01 * i);
        f.push_back(x.back() * x.back());
    }
    CHECK(workOf(x, f) == Approx(8.0 / 3.0 + 2.0 * 1e-4 / 6.0).epsilon(1e-12)); // trapezoid: + (b - a) h^2 f'' / 12
    for (int i = n; i >= 0; --i) { // ... and back along F = x: the loop's area is 8/3 - 2
        x.push_back(0.01 * i);
        f.push_back(x.back());
    }
    CHECK(workOf(x, f) == Approx(8.0 / 3.0 - 2.0 + 2.0 * 1e-4 / 6.0).epsilon(1e-10));
}

TEST_CASE("force drops: sizes, places, thresholds", "[lab]") {
    std::vector<double> x, f;
    CHECK(forceDrops(x, f, 0.1, 1.0).empty());
    const auto line = [&](double to, double length, int count) {
        const double from = f.empty() ? 0.0 : f.back(), at = x.empty() ? 0.0 : x.back();
        for (int i = 1; i <= count; ++i) {
            x.push_back(at + length * i / count);
            f.push_back(from + (to - from) * i / count);
        }
    };
    line(1.0, 1.0, 50);
    line(0.4, 0.01, 3); // a snap of 0.6
    line(1.2, 1.0, 50);
    line(1.15, 0.01, 3); // a wiggle below the threshold
    line(2.0, 1.0, 50);
    line(1.0, 5.0, 50); // slow softening is none
    line(1.5, 1.0, 50);
    line(0.5, 0.2, 20); // a snap of 1 at the end, not climbed out of again
    const auto drops = forceDrops(x, f, 0.2, 0.25);
    REQUIRE(drops.size() == 2);
    CHECK(drops[0].size == Approx(0.6).epsilon(1e-12));
    CHECK(f[drops[0].top] == 1.0);
    CHECK(f[drops[0].bottom] == Approx(0.4).epsilon(1e-12));
    CHECK(drops[1].size == Approx(1.0).epsilon(1e-12));
    CHECK(drops[1].bottom == f.size() - 1);
    CHECK(forceDrops(x, f, 0.2, 10.0).size() == 3);  // with the softening
    CHECK(forceDrops(x, f, 0.03, 0.25).size() == 3); // with the wiggle
    CHECK(forceDrops(x, f, 2.0, 10.0).empty());
}

TEST_CASE("a drop with a wiggle inside is one drop", "[lab]") {
    const std::vector<double> x{0, 1, 1.01, 1.02, 1.03, 2}, f{0, 1, 0.5, 0.55, 0.1, 1};
    const auto drops = forceDrops(x, f, 0.2, 0.1);
    REQUIRE(drops.size() == 1);
    CHECK(drops[0].size == Approx(0.9));
}

TEST_CASE("a monotonic or constant curve has no drops", "[lab]") {
    const std::vector<double> x{0, 1, 2, 3}, up{0, 1, 2, 3}, flat{1, 1, 1, 1};
    CHECK(forceDrops(x, up, 0.1, 10.0).empty());
    CHECK(forceDrops(x, flat, 0.1, 10.0).empty());
    CHECK(workOf(x, flat) == 3.0);
}
