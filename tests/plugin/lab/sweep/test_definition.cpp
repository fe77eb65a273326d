// Sweep files: content, errors, and agreement of the JSON Schema with the loader.

#include "plugin/lab/sweep/definition.h"
#include "tests/support/json.h"
#include "tests/support/schema.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

using namespace supercircle;
using namespace supercircle::sweep;
using Catch::Contains;
using nlohmann::json;

namespace {

std::optional<SweepDefinition> read(const std::string& text, std::string& complaints) {
    std::vector<scene::Problem> problems;
    auto sweep = loadText(text, "folder/s.json", problems);
    complaints.clear();
    for (const scene::Problem& p : problems)
        complaints += p.toString() + "\n";
    return sweep;
}

SweepDefinition valid(const std::string& text) {
    std::string complaints;
    const auto sweep = read(text, complaints);
    INFO(complaints);
    REQUIRE(sweep);
    return *sweep;
}

bool schemaAccepts(const json& document) {
    return test::schemaErrors("plugin/lab/sweep/sweep.schema.json", document).empty();
}

const std::string kHead = R"({"schema": "supercircle-sweep/1", "scene": "../a.json")";

} // namespace

TEST_CASE("a grid is the product of its axes, cases multiply it, the first name varies slowest") {
    const SweepDefinition s = valid(kHead + R"(, "cases": [{"shells": 30, "width": 0.2}, {"shells": 100, "width": 0.4}],
        "grid": {"mu": [0.1, 1], "x": {"from": 0, "to": 1, "count": 3}}, "fixed": {"cycles": 2},
        "seeds": {"first": 5, "last": 7}, "report": {"x": "shells"}})");
    CHECK(s.scene == "a.json"); // relative to the sweep's folder
    CHECK(s.names == std::vector<std::string>{"shells", "width", "mu", "x"});
    REQUIRE(s.sets.size() == 12);
    CHECK(s.sets.front() == std::vector<double>{30, 0.2, 0.1, 0});
    CHECK(s.sets[1] == std::vector<double>{30, 0.2, 0.1, 0.5});
    CHECK(s.sets.back() == std::vector<double>{100, 0.4, 1, 1});
    CHECK(s.seeds == std::vector<std::int64_t>{5, 6, 7});
    CHECK(s.x == "shells");
    CHECK(keyOf(s.parameterValues(1)) == "cycles=2 mu=0.1 shells=30 width=0.2 x=0.5");
}

TEST_CASE("a sweep without a grid is one set, without seeds it is one run") {
    const SweepDefinition s = valid(kHead + "}");
    CHECK(s.sets.size() == 1);
    CHECK(s.seeds == std::vector<std::int64_t>{1});
    CHECK(s.x.empty());
}

TEST_CASE("errors of a sweep are reported with their place") {
    const auto refused = [](const std::string& rest, const std::string& what) {
        std::string complaints;
        CHECK_FALSE(read(kHead + rest + "}", complaints));
        CHECK_THAT(complaints, Contains(what));
        CHECK_THAT(complaints, Contains("folder/s.json:1:"));
    };
    refused(R"(, "grid": {"mu": []})", "/grid/mu: no values");
    refused(R"(, "grid": {"mu": [1, "a"]})", "/grid/mu/1: this is a text");
    refused(R"(, "grid": {"mu": [1, 2, 1]})", "/grid/mu/2: this value appears twice");
    refused(R"(, "grid": {"mu": {"from": 1, "too": 2, "count": 3}})", "did you mean \"to\"");
    refused(R"(, "grid": {"mu": [1]}, "cases": [{"mu": 2}])", "varies in \"cases\" already");
    refused(R"(, "grid": {"mu": [1]}, "fixed": {"mu": 2})", "/fixed/mu: this parameter varies");
    refused(R"(, "cases": [{"a": 1}, {"b": 1}])", "/cases/1: this case does not name");
    refused(R"(, "seeds": {"first": 3, "last": 2})", "first <= last");
    refused(R"(, "seeds": [1.5])", "whole numbers");
    refused(R"(, "grid": {"phi_bar": [0.6]}, "report": {"x": "phi_bra"})", "did you mean \"phi_bar\"");
    refused(R"(, "grids": {})", "did you mean \"grid\"");
    refused(R"(, "seeds": {"last": 100000000})", "at most");
    std::string complaints;
    CHECK_FALSE(read(R"({"schema": "supercircle-sweep/1"})", complaints));
    CHECK_THAT(complaints, Contains("\"scene\" is missing"));
    CHECK_FALSE(read(R"({"schema": "supercircle-sweep/2", "scene": "a"})", complaints));
    CHECK_THAT(complaints, Contains("not a sweep of this version"));
}

TEST_CASE("the sweeps of the project agree with loader and schema, and the schema refuses what the loader refuses") {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(std::string(SC_SOURCE_DIR) + "/scenes/sweeps")) {
        INFO(entry.path());
        std::vector<scene::Problem> problems;
        const auto sweep = load(entry.path().string(), problems);
        REQUIRE(sweep);
        CHECK(std::filesystem::exists(sweep->scene));
        CHECK(schemaAccepts(test::jsonOf(entry.path().string())));
        ++files;
    }
    CHECK(files > 0);
    for (const char* rest :
         {R"(, "grid": {"mu": []})", R"(, "grid": {"mu": ["a"]})", R"(, "grid": {"mu": [1, 1]})", R"(, "grids": {})",
          R"(, "seeds": [1.5])", R"(, "seeds": {"first": 1})", R"(, "fixed": {"mu": "a"})", R"(, "report": {"y": "a"})",
          R"(, "seeds": [])", R"(, "seeds": [-1])"}) {
        INFO(rest);
        std::string complaints;
        CHECK_FALSE(read(kHead + rest + "}", complaints));
        CHECK_FALSE(schemaAccepts(test::parseJson(kHead + rest + "}")));
    }
}

TEST_CASE("shards share the runs without gap or overlap, and every set grows evenly") {
    const SweepDefinition s = valid(kHead + R"(, "grid": {"a": [1, 2, 3], "b": [1, 2]}, "seeds": {"last": 7}})");
    const std::vector<Task> all = tasks(s, {});
    REQUIRE(all.size() == 42);
    for (std::size_t i = 0; i < all.size(); ++i) { // at any time no set is ahead of another by more than one run
        CHECK(all[i].set == i % 6);
        CHECK(all[i].seed == static_cast<std::int64_t>(i / 6) + 1);
    }
    for (const int parts : {1, 2, 4, 5, 50}) {
        std::set<std::pair<std::size_t, std::int64_t>> seen;
        std::size_t least = all.size(), most = 0;
        for (int part = 1; part <= parts; ++part) {
            const std::vector<Task> some = tasks(s, {part, parts});
            least = std::min(least, some.size());
            most = std::max(most, some.size());
            for (const Task& t : some)
                CHECK(seen.emplace(t.set, t.seed).second);
        }
        CHECK(seen.size() == all.size());
        CHECK(most - least <= 1);
    }
}

TEST_CASE("seeds and shards are read from the command line or refused") {
    CHECK(parseSeeds("3") == std::vector<std::int64_t>{3});
    CHECK(parseSeeds("1:3,8,2:4") == std::vector<std::int64_t>{1, 2, 3, 4, 8});
    for (const char* text : {"", "a", "3:1", "1:", ":3", "-1", "1,,2", "1:2:3", "1 2"})
        CHECK(parseSeeds(text).empty());
    REQUIRE(parseShard("2/4"));
    CHECK(parseShard("2/4")->part == 2);
    for (const char* text : {"", "0/4", "5/4", "1", "1/", "/2", "a/b", "1/2/3"})
        CHECK_FALSE(parseShard(text));
}
