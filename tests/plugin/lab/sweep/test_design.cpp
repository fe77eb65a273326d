// Inverse design on a known response surface.

#include "plugin/lab/sweep/design.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::sweep;
using Catch::Contains;

namespace {

/// Runs whose number is 10 phi + 2 log10(mu), scattered symmetrically by 0.2.
RunTable tableOf(SweepDefinition& sweep) {
    sweep.names = {"phi_bar", "mu"};
    sweep.x = "phi_bar";
    RunTable table;
    table.columns = {"delta"};
    for (const double phi : {0.5, 0.6, 0.9})
        for (const double mu : {0.1, 1.0}) {
            for (int seed = 1; seed <= 21; ++seed) {
                Row row;
                row.set = sweep.sets.size();
                row.seed = seed;
                row.status = "done";
                row.cells.emplace_back(10.0 * phi + 2.0 * std::log10(mu) + 0.02 * (seed - 11));
                table.rows.push_back(row);
            }
            sweep.sets.push_back({phi, mu});
        }
    return table;
}

} // namespace

TEST_CASE("a surface linear in angle and logarithm of friction is interpolated and inverted exactly") {
    SweepDefinition sweep;
    const RunTable table = tableOf(sweep);
    const auto surface = responseSurface(sweep, table, "delta");
    REQUIRE(surface);
    const ResponseSurface& s = *surface;
    for (const double phi : {0.5, 0.55, 0.73, 0.9})
        for (const double mu : {0.1, 0.2, 0.5, 1.0})
            CHECK(s.at(phi, mu).mean == Approx(10.0 * phi + 2.0 * std::log10(mu)).epsilon(1e-12));
    CHECK(s.at(0.7, 0.3).spread == Approx(1.4826 * 0.1).epsilon(1e-4)); // MAD of -0.2, -0.18, ..., 0.2: 0.1
    const auto solutions = solveFor(s, 6.0, 0.3);
    REQUIRE(solutions.size() == 1);
    CHECK(solutions[0].x == Approx(0.6 - 0.2 * std::log10(0.3)).epsilon(1e-12));
    CHECK(solutions[0].xError == Approx(solutions[0].value.error / 10.0));
    CHECK(solveFor(s, 100.0, 0.3).empty());
    CHECK(solveFor(s, 9.0, 1.0).size() == 1); // the end of the grid belongs to it
    CHECK(solveFor(s, 6.0, 1.0).size() == 1); // a point of the grid is found once
}

TEST_CASE("scatter falls with the root of the number of shells") {
    CHECK(scaledSpread(0.3, 30.0, 30.0) == 0.3);
    CHECK(scaledSpread(0.3, 30.0, 120.0) == Approx(0.15));
}

TEST_CASE("results that give no surface are refused") {
    SweepDefinition sweep;
    RunTable table = tableOf(sweep);
    CHECK_THAT(responseSurface(sweep, table, "delto").error(), Contains("did you mean \"delta\""));
    SweepDefinition holes = sweep;
    holes.sets.pop_back();
    CHECK_THAT(responseSurface(holes, table, "delta").error(), Contains("do not form a full grid"));
    table.rows.resize(30);
    CHECK_THAT(responseSurface(sweep, table, "delta").error(), Contains("too few runs"));
}

TEST_CASE("an unknown quantity that resembles none gets no empty suggestion") {
    SweepDefinition sweep;
    const RunTable table = tableOf(sweep);
    CHECK(responseSurface(sweep, table, "work").error() == "the runs have no quantity \"work\"");
}
