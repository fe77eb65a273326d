// The largest energy that one shell releases at once: a measure of abruptness.

#include "plugin/lab/session/energy_release.h"

#include <catch2/catch.hpp>
#include <cmath>

using supercircle::lab::EnergyRelease;

TEST_CASE("the largest fall of one shell's energy within a travel window", "[lab][release]") {
    EnergyRelease slow(0.1), abrupt(0.1), shared(0.1);
    for (int i = 0; i <= 1000; ++i) {
        const double travel = 1e-3 * i;
        slow.sample(travel, {1.0 - travel});                                  // 0.1 J in any 0.1 m
        abrupt.sample(travel, {travel < 0.5 ? travel : 0.2, 1.0});            // 0.5 falls to 0.2 J at once
        shared.sample(travel, {0.5 + 0.5 * travel, 1.0 - 0.5 * travel, 2.0}); // passed from shell to shell
    }
    CHECK(slow.largest() == Approx(0.1).epsilon(1e-9));
    CHECK(abrupt.largest() == Approx(0.299).epsilon(1e-9));
    CHECK(shared.largest() == Approx(0.05).epsilon(1e-9));
    EnergyRelease anew(0.1);
    anew.sample(0.0, {1.0});
    anew.restart(); // the next branch begins lower
    anew.sample(0.0, {0.2});
    CHECK(anew.largest() == 0.0);
    anew.sample(0.01, {0.1, 5.0}); // one more shell
    CHECK(anew.largest() == Approx(0.1));
}
