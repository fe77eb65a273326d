// The subcommand `sweep`: its files do not depend on interruptions, shards or resumption.

#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/result_store.h"
#include "tests/plugin/cli/program.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <random>
#include <set>

using namespace supercircle;
using namespace supercircle::test;
using Catch::Contains;

namespace {

/// Some hundredths of a second a run.
std::string sweepFile(const Folder& folder, int seeds) {
    return folder.write("sweep.json", R"({"schema": "supercircle-sweep/1", "scene": ")" +
                                          test::scene("shell_on_cylinder") +
                                          R"(", "grid": {"phi_bar": [0.65, 0.75], "mu": [0.1, 0.35]},
        "fixed": {"elements": 8, "speed": 0.02}, "seeds": {"last": )" +
                                          std::to_string(seeds) + "}}");
}

CommandResult sweepInto(const std::string& file, const std::string& out, std::vector<std::string> more,
                        const Start& how = {}) {
    more.insert(more.begin(), {"sweep", file, "--out", out, "--quiet"});
    return start(more, how);
}

/// The files that must be equal.
std::string tables(const std::string& out) {
    return contentOf(out + "/results.csv") + contentOf(out + "/statistics.csv") + contentOf(out + "/failed.csv");
}

/// Number of missing runs before the last stored one: those that were in progress.
std::size_t lost(const std::string& file, const std::string& out, std::size_t& kept) {
    kept = 0;
    if (!std::filesystem::exists(out)) // killed before it began
        return 0;
    std::vector<scene::Problem> problems;
    const auto sweep = sweep::load(file, problems);
    REQUIRE(sweep);
    sweep::ResultStore store;
    REQUIRE(store.open(out + "/results.sqlite").empty());
    const auto finished = store.finished();
    REQUIRE(finished);
    kept = finished->size();
    std::size_t missing = 0, holes = 0;
    for (const sweep::Task& t : sweep::tasks(*sweep, {})) {
        if (finished->count({sweep::keyOf(sweep->parameterValues(t.set)), t.seed}) == 0)
            ++missing;
        else
            holes = missing;
    }
    return holes;
}

/// Kills and resumes a sweep repeatedly; then compares it with an undisturbed one.
void killAndResume(int seeds, int kills, int jobs) {
    const Folder folder;
    const std::string file = sweepFile(folder, seeds);
    REQUIRE(sweepInto(file, folder / "whole", {"--jobs", "2"}).code == 0);
    std::mt19937 random(static_cast<unsigned>(seeds + jobs)); // NOLINT: a fixed seed
    std::uniform_real_distribution<double> delay(0.02, 0.35);
    std::size_t before = 0;
    int killed = 0;
    for (int i = 0; i < kills; ++i) {
        const CommandResult ending = sweepInto(file, folder / "torn", {"--resume", "--jobs", std::to_string(jobs)},
                                               {.signal = SIGKILL, .signalAfter = delay(random)});
        killed += ending.code == 128 + SIGKILL ? 1 : 0;
        std::size_t kept = 0;
        CHECK(lost(file, folder / "torn", kept) < static_cast<std::size_t>(jobs)); // at most one a worker
        CHECK(kept >= before);
        before = kept;
    }
    CHECK(killed > 0);
    REQUIRE(sweepInto(file, folder / "torn", {"--resume"}).code == 0);
    CHECK(tables(folder / "torn") == tables(folder / "whole"));
    REQUIRE(sweepInto(file, folder / "torn", {"--resume"}).code == 0); // nothing left to do
    CHECK(tables(folder / "torn") == tables(folder / "whole"));
}

} // namespace

TEST_CASE("a sweep that is killed and resumed ends with the same bytes") {
    killAndResume(5, 4, 2);
}

TEST_CASE("fifty kills of a sweep of two hundred runs lose nothing", "[slow]") {
    for (const int jobs : {1, 3})
        killAndResume(50, 25, jobs);
}

TEST_CASE("merged shards equal the sweep, and so does a sweep that was extended") {
    const Folder folder;
    const std::string file = sweepFile(folder, 3);
    REQUIRE(sweepInto(file, folder / "whole", {}).code == 0);
    for (const char* part : {"1", "2", "3"})
        REQUIRE(sweepInto(file, folder / part, {"--shard", std::string(part) + "/3"}).code == 0);
    const CommandResult merged =
        sweepInto(file, folder / "merged", {"--merge", folder / "1", folder / "2", folder / "3"});
    INFO(merged.err);
    REQUIRE(merged.code == 0);
    CHECK(tables(folder / "merged") == tables(folder / "whole"));
    REQUIRE(sweepInto(file, folder / "grown", {"--seeds", "2"}).code == 0);
    CHECK(tables(folder / "grown") != tables(folder / "whole"));
    REQUIRE(sweepInto(file, folder / "grown", {"--resume", "--merge", folder / "1"}).code == 0);
    REQUIRE(sweepInto(file, folder / "grown", {"--resume"}).code == 0);
    CHECK(tables(folder / "grown") == tables(folder / "whole"));
}

TEST_CASE("the page holds its pictures, and tables have the promised columns") {
    const Folder folder;
    const std::string file = sweepFile(folder, 2);
    const CommandResult ending = start({"sweep", file, "--out", folder / "out"});
    REQUIRE(ending.code == 0);
    CHECK_THAT(ending.out, Contains("8 runs of 4 sets") && Contains("report.html"));
    const std::string page = contentOf(folder / "out/report.html");
    CHECK_THAT(page, Contains("<svg") && Contains("μ = 0.35") && Contains("</html>"));
    CHECK(page.find("src=\"http") == std::string::npos); // self-contained
    CHECK_THAT(contentOf(folder / "out/results.csv"),
               Contains("elements,speed,phi_bar,mu,seed,status,") && Contains(",crossings,"));
    CHECK_THAT(contentOf(folder / "out/statistics.csv"), Contains("quantity,n,mean,median,mad,"));
    CHECK_THAT(contentOf(folder / "out/peak_force_R2_over_B.png").substr(1, 3), Contains("PNG"));
    CHECK(contentOf(folder / "out/results.csv").find("wall_s") == std::string::npos);
    CHECK_THAT(contentOf(folder / "out/timings.csv"), Contains("wall_s"));
}

TEST_CASE("a parameter that varies with the abscissa makes no lines of its own, and the legend names it") {
    const Folder folder;
    const std::string file = folder.write("sweep.json", R"({"schema": "supercircle-sweep/1", "scene": ")" +
                                                            test::scene("shell_on_cylinder") +
                                                            R"(", "grid": {"mu": [0.1, 0.35]},
        "cases": [{"phi_bar": 0.65, "elements": 8}, {"phi_bar": 0.75, "elements": 10}],
        "fixed": {"speed": 0.05}, "report": {"x": "phi_bar"}})");
    REQUIRE(sweepInto(file, folder / "out", {}).code == 0);
    const std::string page = contentOf(folder / "out/report.html");
    CHECK_THAT(page, Contains("μ = 0.35") && Contains("elements along with Φ / 2π"));
    CHECK_THAT(page, !Contains("elements = 10"));
}

TEST_CASE("runs that fail are exit 3, listed with seed and command, and do not stop the others") {
    const Folder folder;
    // Turns by thousands of circles in the smallest step: the shell is quarantined, which ends the experiment.
    folder.write("fast.json", R"({ "parameters": { "v": { "value": 0 } }, "duration": 0.01,
        "shell": [ { "spin": { "param": "v" } } ] })");
    const std::string file = folder.write(
        "sweep.json",
        R"({"schema": "supercircle-sweep/1", "scene": "fast.json", "grid": {"v": [0, 1e12, 0.5]}, "seeds": [4, 6]})");
    const CommandResult ending = sweepInto(file, folder / "out", {});
    CHECK(ending.code == 3);
    CHECK_THAT(ending.err, Contains("--param v=1e+12 --seed 4") && Contains("--seed 6"));
    const std::string failed = contentOf(folder / "out/failed.csv");
    CHECK(std::count(failed.begin(), failed.end(), '\n') == 3); // header and two runs
    const std::string results = contentOf(folder / "out/results.csv");
    CHECK(std::count(results.begin(), results.end(), '\n') == 7);
    CHECK_THAT(contentOf(folder / "out/report.html"), Contains("Runs that failed"));
}

TEST_CASE("a folder of results is not mixed with others") {
    const Folder folder;
    const std::string file = sweepFile(folder, 1);
    REQUIRE(sweepInto(file, folder / "out", {"--shard", "1/2"}).code == 0);
    const auto refused = [&](const std::string& sweep, const std::vector<std::string>& more, const std::string& what) {
        const CommandResult ending = sweepInto(sweep, folder / "out", more);
        CHECK(ending.code == 2);
        CHECK_THAT(ending.err, Contains(what));
    };
    refused(file, {}, "--resume");
    refused(file, {"--resume", "--shard", "2/2"}, "holds shard 1/2");
    refused(file, {"--shard", "3/2"}, "--shard 3/2");
    refused(file, {"--seeds", "a"}, "--seeds a");
    CHECK_THAT(sweepInto(file, folder / "merged", {"--merge", folder / "nothing"}).err, Contains("no such file"));
    const std::string other = folder.write("other.json", R"({"schema": "supercircle-sweep/1", "scene": ")" +
                                                             test::scene("two_shells") + R"("})");
    refused(other, {"--resume", "--shard", "1/2"}, "another version of the scene");
    refused(folder.write("bad.json", R"({"schema": "supercircle-sweep/1", "scene": ")" + test::scene("ramp") +
                                         R"(", "grid": {"mew": [1]}})"),
            {}, "mew");
    refused(test::scene("ramp"), {}, "schema");
}

TEST_CASE("check reads sweeps, and tries every set of their parameters") {
    const Folder folder;
    const CommandResult valid = start({"check", sweepFile(folder, 3)});
    CHECK(valid.code == 0);
    CHECK_THAT(valid.out, Contains("4 sets of parameters, 3 seeds, 12 runs"));
    const CommandResult bad =
        start({"check", folder.write("bad.json", R"({"schema": "supercircle-sweep/1", "scene": ")" +
                                                     test::scene("ramp") + R"(", "grid": {"mu": [1, -5]}})")});
    CHECK(bad.code == 2);
    CHECK_THAT(bad.err, Contains("mu=-5"));
    CHECK_THAT(start({"run", sweepFile(folder, 1)}).err, Contains("supercircle sweep"));
    CHECK(start({"check", sweepFile(folder, 1), "--param", "mu=1"}).code == 2);
}

TEST_CASE("an interrupted sweep keeps what is done and says how to continue") {
    const Folder folder;
    const CommandResult ending =
        sweepInto(sweepFile(folder, 2000), folder / "out", {"--jobs", "2"}, {.signal = SIGINT, .signalAfter = 0.6});
    CHECK(ending.code == 130);
    CHECK_THAT(ending.err, Contains("--resume"));
    CHECK_THAT(contentOf(folder / "out/results.csv"), Contains(",seed,status"));
}

TEST_CASE("a sweep has one accuracy", "[cli][sweep]") {
    const Folder folder;
    const std::string file = sweepFile(folder, 1), out = folder / "out";
    REQUIRE(sweepInto(file, out, {"--accuracy", "fast"}).code == 0);
    const CommandResult other = sweepInto(file, out, {"--resume"});
    CHECK(other.code == 2);
    CHECK_THAT(other.err, Contains("another accuracy: fast"));
    CHECK(sweepInto(file, out, {"--resume", "--accuracy", "fast"}).code == 0);
    CHECK(sweepInto(file, folder / "none", {"--accuracy", "best"}).code == 2);
}
