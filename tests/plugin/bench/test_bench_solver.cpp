// The solver benchmark on its smallest sets: numbers, table and picture agree.

#include "tests/plugin/cli/program.h"
#include "tests/support/json.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace supercircle::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("the solver benchmark measures every method on a recorded stack") {
    const Folder folder;
    const CommandResult ending = start({"bench", "--filter", "solver/nest/3/", "--json", folder / "solver.json"});
    REQUIRE(ending.code == 0);
    CHECK_THAT(ending.out, Contains("| set | shells | contacts |") && Contains("| nest | 3 |"));
    const json figures = jsonOf(folder / "solver.json");
    REQUIRE(figures["benchmarks"].size() == 12); // six columns, two tolerances
    for (const json& row : figures["benchmarks"]) {
        const std::string name = row["name"];
        CHECK_THAT(name, Catch::StartsWith("solver/nest/3/"));
        CHECK(row["median_ms"] > 0.0);
        CHECK(row["samples"] >= 10);
        CHECK(row["active_mean"] <= row["contacts_mean"]);
        CHECK(row["reached"] <= 1.0);
        if (name.find("/strategy/") != std::string::npos)
            CHECK(row["reached"] == 1.0); // the default method is there to reach the tolerance
    }
    CHECK_THAT(contentOf(folder / "solver.png"), Catch::StartsWith("\x89PNG"));
    CHECK(folder.entries().size() == 2);
}

TEST_CASE("the solver benchmark runs only when asked for") {
    const CommandResult ending = start({"bench", "--filter", "nest/3/strategy"});
    CHECK(ending.code == 2);
    CHECK_THAT(ending.err, Contains("solver") && Contains("only with a --filter that begins with it"));
}
