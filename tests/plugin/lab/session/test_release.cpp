// The largest energy a shell lets go at once: a measure of abruptness.

#include "plugin/lab/session/release.h"

#include <catch2/catch.hpp>
#include <cmath>

using supercircle::lab::Release;

TEST_CASE("the largest fall of one shell's energy within a way", "[lab][release]") {
    Release slow(0.1), abrupt(0.1), shared(0.1);
    for (int i = 0; i <= 1000; ++i) {
        const double way = 1e-3 * i;
        slow.sample(way, {1.0 - way});                               // 0.1 J in any 0.1 m
        abrupt.sample(way, {way < 0.5 ? way : 0.2, 1.0});            // 0.5 falls to 0.2 J at once
        shared.sample(way, {0.5 + 0.5 * way, 1.0 - 0.5 * way, 2.0}); // handed on from shell to shell
    }
    CHECK(slow.largest() == Approx(0.1).epsilon(1e-9));
    CHECK(abrupt.largest() == Approx(0.299).epsilon(1e-9));
    CHECK(shared.largest() == Approx(0.05).epsilon(1e-9));
    Release anew(0.1);
    anew.sample(0.0, {1.0});
    anew.restart(); // the next branch begins lower
    anew.sample(0.0, {0.2});
    CHECK(anew.largest() == 0.0);
    anew.sample(0.01, {0.1, 5.0}); // a shell more
    CHECK(anew.largest() == Approx(0.1));
}
