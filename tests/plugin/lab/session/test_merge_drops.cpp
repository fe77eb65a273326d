// A snap that rings is one snap. Displacements in m, forces in N; drops are of 0.5 N within 0.5 m, and those that
// follow within 0.05 m are merged.

#include "plugin/lab/session/force_curve.h"

#include <catch2/catch.hpp>

using namespace supercircle::lab;

TEST_CASE("force drops that ring after one snap are one event, a later snap is another", "[curve]") {
    const std::vector<double> d = {0.0, 1.0, 1.01, 1.02, 1.03, 2.0, 2.01, 3.0};
    const std::vector<double> f = {0.0, 3.0, 1.0, 2.0, 1.0, 4.0, 2.0, 5.0};
    const auto drops = forceDrops(d, f, 0.5, 0.5);
    REQUIRE(drops.size() == 3);
    const auto merged = mergeDrops(d, f, drops, 0.05);
    REQUIRE(merged.size() == 2);
    CHECK(merged[0].top == 1);
    CHECK(merged[0].bottom == 4);
    CHECK(merged[0].size == 2.0);
    CHECK(merged[1].top == 5);
}

TEST_CASE("a fall that rebounds on its way is as large as the whole of it", "[curve]") {
    const std::vector<double> d = {0.0, 1.0, 1.01, 1.02, 1.03, 1.5};
    const std::vector<double> f = {0.0, 5.0, 3.0, 3.6, 1.0, 2.0};
    const auto merged = mergeDrops(d, f, forceDrops(d, f, 0.5, 0.5), 0.05);
    REQUIRE(merged.size() == 1);
    CHECK(merged[0].size == 4.0);
    // A ring that swings above the first top falls farther than it.
    const std::vector<double> g = {0.0, 2.0, 1.0, 4.0, 1.5, 2.0};
    const auto rung = mergeDrops(d, g, forceDrops(d, g, 0.5, 0.5), 0.05);
    REQUIRE(rung.size() == 1);
    CHECK(rung[0].size == 2.5);
}
