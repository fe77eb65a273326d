// The runs on disk, and the processes that execute them.

#include "plugin/lab/sweep/result_store.h"
#include "plugin/lab/sweep/run_record.h"
#include "plugin/lab/sweep/run_table.h"
#include "plugin/lab/sweep/workers.h"
#include "tests/support/folder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <unistd.h>

using namespace supercircle;
using namespace supercircle::sweep;
using Catch::Contains;
using supercircle::test::Folder;

namespace {

SweepDefinition twoByThree() {
    SweepDefinition d;
    d.scene = "scenes/a scene.json";
    d.names = {"phi_bar", "mu"};
    d.fixed = {{"cycles", 2.0}};
    d.sets = {{0.5, 0.1}, {0.5, 1.0}};
    d.seeds = {1, 2, 3};
    d.x = "mu";
    return d;
}

StoredRun runOf(const SweepDefinition& d, std::size_t set, std::int64_t seed, const std::string& status = "done") {
    StoredRun run;
    run.parameters = keyOf(d.parameterValues(set));
    run.seed = seed;
    run.status = status;
    run.message = status == "done" ? "" : "a \"reason\", with a comma";
    if (status == "crashed")
        return run;
    RunRecord result;
    result.status = status;
    result.summary = {{"dissipation_ratio", 0.1 * static_cast<double>(set + 1) + 1e-3 * static_cast<double>(seed)},
                      {"snap_fits", std::int64_t{7}},
                      {"snap_type", std::string("II")}};
    result.cycles = {{3.25, 0.1, 4, 1.0 / 3.0}, {3.0, 0.05, 1, 0.2}};
    run.result = serialise(result);
    run.wall = 2.0;
    return run;
}

/// The text of all runs, whatever the order in which they came.
std::string tables(const SweepDefinition& d, ResultStore& store) {
    const auto table = collect(d, store);
    REQUIRE(table);
    return resultsCsv(d, *table) + cyclesCsv(d, *table) + failedCsv(d, *table);
}

} // namespace

TEST_CASE("a record survives serialisation to the last bit, and an incomplete one is refused") {
    RunRecord r;
    r.status = "done";
    r.message = "a \"word\"\n";
    r.summary = {{"a", 1.0 / 3.0}, {"b", std::int64_t{-5}}, {"c", true}, {"d", std::string("I")}, {"e", 2.0}};
    r.timing = {{"wall_s", 0.1}};
    r.cycles = {{1.0 / 7.0, 2.0 / 7.0, 3, 1e-300}};
    r.branches = {{{0.0, 0.25}, {0.0, 5.0}}, {{0.25, 0.0}, {5.0, 0.0}}};
    const std::string text = serialise(r);
    const auto back = deserialise(text);
    REQUIRE(back);
    CHECK(back->summary == r.summary);
    CHECK(back->timing == r.timing);
    REQUIRE(back->cycles.size() == 1);
    CHECK(back->cycles[0].delta_max_over_R == 1.0 / 7.0);
    CHECK(back->cycles[0].dissipated_J == 1e-300);
    REQUIRE(back->branches.size() == 2);
    CHECK(back->branches[1].force == r.branches[1].force);
    CHECK(serialise(*back) == text);
    for (const std::size_t length : {std::size_t{0}, std::size_t{1}, text.size() / 2, text.size() - 1})
        CHECK_FALSE(deserialise(text.substr(0, length)));
}

TEST_CASE("curves are split where the crosshead turns, thinned, and keep their extremes") {
    record::Recording recording;
    recording.series.names = {"time_s", "displacement_m", "force_N"};
    recording.series.columns.resize(3);
    const int half = 4000;
    for (int i = 0; i <= 2 * half; ++i) {
        recording.series.columns[0].push_back(i);
        recording.series.columns[1].push_back(1e-5 * (half - std::abs(i - half)));
        recording.series.columns[2].push_back(i == 1234 ? 9.0 : i == 5678 ? -3.0 : 1.0);
    }
    recording.summary = {{"dissipation_ratio", 0.5}, {"seed", std::int64_t{1}}};
    recording.timing = {{"wall_s", 3.0}, {"stage_solve_s", 1.0}};
    const RunRecord r = recordOf(recording, "done", "");
    CHECK(r.summary ==
          std::vector<std::pair<std::string, record::Value>>{{"dissipation_ratio", 0.5}}); // no timing in results
    CHECK(r.timing.size() == 2);
    REQUIRE(r.branches.size() == 2);
    for (const CurveBranch& branch : r.branches)
        CHECK(branch.force.size() < 500);
    CHECK(*std::max_element(r.branches[0].force.begin(), r.branches[0].force.end()) == 9.0);
    CHECK(*std::min_element(r.branches[1].force.begin(), r.branches[1].force.end()) == -3.0);
    CHECK(r.branches[0].displacement.back() == r.branches[1].displacement.front());
}

TEST_CASE("tables do not depend on the order of the runs, nor on the stores they came from") {
    const Folder folder;
    const SweepDefinition d = twoByThree();
    ResultStore forward, backward, left, right;
    REQUIRE(forward.open(folder.path + "/forward").empty());
    REQUIRE(backward.open(folder.path + "/backward").empty());
    REQUIRE(left.open(folder.path + "/left").empty());
    REQUIRE(right.open(folder.path + "/right").empty());
    const std::vector<Task> all = tasks(d, {});
    for (std::size_t i = 0; i < all.size(); ++i) {
        REQUIRE(forward.save(runOf(d, all[i].set, all[i].seed)).empty());
        const Task& other = all[all.size() - 1 - i];
        REQUIRE(backward.save(runOf(d, other.set, other.seed)).empty());
        REQUIRE((i % 3 == 0 ? left : right).save(runOf(d, all[i].set, all[i].seed)).empty());
    }
    const std::string text = tables(d, forward);
    CHECK_THAT(text,
               Contains("cycles,phi_bar,mu,seed,status,dissipation_ratio,snap_fits,snap_type\n2,0.5,0.1,1,done,"));
    CHECK(tables(d, backward) == text);
    REQUIRE(left.mergeFrom(right).empty());
    CHECK(tables(d, left) == text);
}

TEST_CASE("crashed runs are repeated, failed ones are not, both are listed with a command") {
    const Folder folder;
    const SweepDefinition d = twoByThree();
    {
        ResultStore store;
        REQUIRE(store.open(folder.path + "/store").empty());
        REQUIRE(store.save(runOf(d, 0, 1)).empty());
        REQUIRE(store.save(runOf(d, 0, 2, "failed")).empty());
        REQUIRE(store.save(runOf(d, 1, 1, "crashed")).empty());
        REQUIRE(store.setMeta("scene", "text").empty());
    }
    ResultStore store; // opened again, as after a kill
    REQUIRE(store.open(folder.path + "/store").empty());
    CHECK(store.meta("scene").value() == "text");
    CHECK(store.meta("nothing").value().empty());
    const auto finished = store.finished();
    REQUIRE(finished);
    CHECK(finished->size() == 2);
    CHECK(finished->count({keyOf(d.parameterValues(1)), 1}) == 0);
    const std::string text = tables(d, store);
    CHECK_THAT(text, Contains("2,0.5,0.1,2,failed,\"a \"\"reason\"\", with a comma\",supercircle run"));
    CHECK_THAT(text, Contains("--param cycles=2 --param phi_bar=0.5 --param mu=1 --seed 1"));
    REQUIRE(store.save(runOf(d, 1, 1)).empty());
    CHECK(store.finished().value().size() == 3);
}

TEST_CASE("results of another format are refused with a message that says what to do") {
    const Folder folder;
    ResultStore store;
    REQUIRE(store.open(folder.path + "/store").empty());
    CHECK(store.checkFormat().empty()); // new
    REQUIRE(store.setMeta("format", kStoreFormat).empty());
    CHECK(store.checkFormat().empty());
    REQUIRE(store.setMeta("format", "supercircle-sweep-store/1").empty());
    CHECK_THAT(store.checkFormat(), Contains("supercircle-sweep-store/1") && Contains("run the sweep again"));
}

TEST_CASE("a file of another kind is an error, not a crash") {
    const Folder folder;
    ResultStore store;
    CHECK_THAT(store.open("/proc/nothing/store"), Contains("/proc/nothing/store"));
    std::filesystem::create_directory(folder.path + "/directory");
    ResultStore directory;
    CHECK_FALSE(directory.open(folder.path + "/directory").empty());
}

TEST_CASE("a crash of one process does not stop the other runs") {
    std::vector<Task> all;
    for (std::int64_t seed = 1; seed <= 12; ++seed)
        all.push_back({0, seed});
    for (const int jobs : {1, 3}) {
        std::vector<FinishedTask> ended;
        WorkPlan work;
        work.jobs = jobs;
        work.runTask = [](const Task& t) -> std::string {
            if (t.seed == 3)
                std::raise(SIGKILL);
            if (t.seed == 5)
                ::_exit(9);
            if (t.seed == 7)
                throw std::runtime_error("no way");
            if (t.seed == 9)
                throw TaskInterrupted{};
            return std::string(static_cast<std::size_t>(t.seed) * 100'000, 'x'); // far more than a pipe holds
        };
        work.onFinished = [&](const FinishedTask& f) {
            ended.push_back(f);
            return std::string();
        };
        REQUIRE(runTasks(all, work).empty());
        REQUIRE(ended.size() == 11); // the interrupted one is not finished
        for (const FinishedTask& f : ended) {
            CHECK(f.signal == (f.task.seed == 3 ? SIGKILL : 0));
            CHECK(f.exitCode == (f.task.seed == 5 ? 9 : f.task.seed == 7 ? kExitException : 0));
            if (f.task.seed == 7)
                CHECK(f.result == "no way");
            else if (f.exitCode == 0 && f.signal == 0)
                CHECK(f.result.size() == static_cast<std::size_t>(f.task.seed) * 100'000);
        }
    }
}

TEST_CASE("work ends at once when results cannot be stored, and when it is interrupted") {
    std::vector<Task> all(20);
    WorkPlan work;
    work.jobs = 2;
    work.runTask = [](const Task&) { return std::string("x"); };
    int kept = 0;
    work.onFinished = [&](const FinishedTask&) { return ++kept == 3 ? "disk full" : ""; };
    CHECK(runTasks(all, work) == "disk full");
    CHECK(kept == 3);
    std::atomic<bool> stop{false};
    work.interrupt = &stop;
    work.runTask = [](const Task&) {
        ::pause(); // until a signal ends it
        return std::string();
    };
    work.onPoll = [&] { stop = true; };
    CHECK(runTasks(all, work).empty());
    CHECK(kept == 3);
}
