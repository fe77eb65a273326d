// The runs on disk, and the processes that play them.

#include "plugin/lab/sweep/run_result.h"
#include "plugin/lab/sweep/store.h"
#include "plugin/lab/sweep/table.h"
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

Definition twoByThree() {
    Definition d;
    d.scene = "scenes/a scene.json";
    d.names = {"phi_bar", "mu"};
    d.fixed = {{"cycles", 2.0}};
    d.sets = {{0.5, 0.1}, {0.5, 1.0}};
    d.seeds = {1, 2, 3};
    d.x = "mu";
    return d;
}

StoredRun runOf(const Definition& d, std::size_t set, std::int64_t seed, const std::string& status = "done") {
    StoredRun run;
    run.parameters = keyOf(d.settings(set));
    run.seed = seed;
    run.status = status;
    run.message = status == "done" ? "" : "a \"reason\", with a comma";
    if (status == "crashed")
        return run;
    RunResult result;
    result.status = status;
    result.summary = {{"eta", 0.1 * static_cast<double>(set + 1) + 1e-3 * static_cast<double>(seed)},
                      {"snap_fits", std::int64_t{7}},
                      {"snap_type", std::string("II")}};
    result.cycles = {{3.25, 0.1, 4, 1.0 / 3.0}, {3.0, 0.05, 1, 0.2}};
    run.result = packed(result);
    run.wall = 2.0;
    return run;
}

/// The text of all runs, whatever the order in which they came.
std::string tables(const Definition& d, Store& store) {
    const auto table = collect(d, store);
    REQUIRE(table);
    return resultsCsv(d, table.value) + cyclesCsv(d, table.value) + failedCsv(d, table.value);
}

} // namespace

TEST_CASE("a result survives packing to the last bit, and a torn one is none") {
    RunResult r;
    r.status = "done";
    r.message = "a \"word\"\n";
    r.summary = {{"a", 1.0 / 3.0}, {"b", std::int64_t{-5}}, {"c", true}, {"d", std::string("I")}, {"e", 2.0}};
    r.timings = {{"wall_s", 0.1}};
    r.cycles = {{1.0 / 7.0, 2.0 / 7.0, 3, 1e-300}};
    r.curve = {{{0.0, 0.25}, {0.0, 5.0}}, {{0.25, 0.0}, {5.0, 0.0}}};
    const std::string text = packed(r);
    const auto back = unpacked(text);
    REQUIRE(back);
    CHECK(back->summary == r.summary);
    CHECK(back->timings == r.timings);
    REQUIRE(back->cycles.size() == 1);
    CHECK(back->cycles[0].delta_max_over_R == 1.0 / 7.0);
    CHECK(back->cycles[0].dissipated_J == 1e-300);
    REQUIRE(back->curve.size() == 2);
    CHECK(back->curve[1].force == r.curve[1].force);
    CHECK(packed(*back) == text);
    for (const std::size_t length : {std::size_t{0}, std::size_t{1}, text.size() / 2, text.size() - 1})
        CHECK_FALSE(unpacked(text.substr(0, length)));
}

TEST_CASE("curves are cut where the machine turns, thinned, and keep their extremes") {
    record::Recording recording;
    recording.series.names = {"time_s", "displacement_m", "force_N"};
    recording.series.columns.resize(3);
    const int half = 4000;
    for (int i = 0; i <= 2 * half; ++i) {
        recording.series.columns[0].push_back(i);
        recording.series.columns[1].push_back(1e-5 * (half - std::abs(i - half)));
        recording.series.columns[2].push_back(i == 1234 ? 9.0 : i == 5678 ? -3.0 : 1.0);
    }
    recording.summary = {{"wall_s", 3.0}, {"eta", 0.5}, {"seed", std::int64_t{1}}, {"stage_solve_s", 1.0}};
    const RunResult r = resultOf(recording, "done", "");
    CHECK(r.summary == std::vector<std::pair<std::string, record::Value>>{{"eta", 0.5}}); // no times in results
    CHECK(r.timings.size() == 2);
    REQUIRE(r.curve.size() == 2);
    for (const Leg& leg : r.curve)
        CHECK(leg.force.size() < 500);
    CHECK(*std::max_element(r.curve[0].force.begin(), r.curve[0].force.end()) == 9.0);
    CHECK(*std::min_element(r.curve[1].force.begin(), r.curve[1].force.end()) == -3.0);
    CHECK(r.curve[0].displacement.back() == r.curve[1].displacement.front());
}

TEST_CASE("tables do not depend on the order in which runs came, nor on where they were kept") {
    const Folder folder;
    const Definition d = twoByThree();
    Store forward, backward, left, right;
    REQUIRE(forward.open(folder.path + "/forward").empty());
    REQUIRE(backward.open(folder.path + "/backward").empty());
    REQUIRE(left.open(folder.path + "/left").empty());
    REQUIRE(right.open(folder.path + "/right").empty());
    const std::vector<Task> all = tasks(d, {});
    for (std::size_t i = 0; i < all.size(); ++i) {
        REQUIRE(forward.keep(runOf(d, all[i].set, all[i].seed)).empty());
        const Task& other = all[all.size() - 1 - i];
        REQUIRE(backward.keep(runOf(d, other.set, other.seed)).empty());
        REQUIRE((i % 3 == 0 ? left : right).keep(runOf(d, all[i].set, all[i].seed)).empty());
    }
    const std::string text = tables(d, forward);
    CHECK_THAT(text, Contains("cycles,phi_bar,mu,seed,status,eta,snap_fits,snap_type\n2,0.5,0.1,1,done,"));
    CHECK(tables(d, backward) == text);
    REQUIRE(left.takeOver(right).empty());
    CHECK(tables(d, left) == text);
}

TEST_CASE("runs whose process died are played again, failed ones are not, both are listed with a command") {
    const Folder folder;
    const Definition d = twoByThree();
    {
        Store store;
        REQUIRE(store.open(folder.path + "/store").empty());
        REQUIRE(store.keep(runOf(d, 0, 1)).empty());
        REQUIRE(store.keep(runOf(d, 0, 2, "failed")).empty());
        REQUIRE(store.keep(runOf(d, 1, 1, "crashed")).empty());
        REQUIRE(store.setMeta("scene", "text").empty());
    }
    Store store; // opened again, as after a kill
    REQUIRE(store.open(folder.path + "/store").empty());
    CHECK(store.meta("scene").value == "text");
    CHECK(store.meta("nothing").value.empty());
    const auto finished = store.finished();
    REQUIRE(finished);
    CHECK(finished.value.size() == 2);
    CHECK(finished.value.count({keyOf(d.settings(1)), 1}) == 0);
    const std::string text = tables(d, store);
    CHECK_THAT(text, Contains("2,0.5,0.1,2,failed,\"a \"\"reason\"\", with a comma\",supercircle run"));
    CHECK_THAT(text, Contains("--param cycles=2 --param phi_bar=0.5 --param mu=1 --seed 1"));
    REQUIRE(store.keep(runOf(d, 1, 1)).empty());
    CHECK(store.finished().value.size() == 3);
}

TEST_CASE("another file than ours is an error, not a crash") {
    const Folder folder;
    Store store;
    CHECK_THAT(store.open("/proc/nothing/store"), Contains("/proc/nothing/store"));
    std::filesystem::create_directory(folder.path + "/directory");
    Store directory;
    CHECK_FALSE(directory.open(folder.path + "/directory").empty());
}

TEST_CASE("whatever happens to one process, the other runs arrive") {
    std::vector<Task> all;
    for (std::int64_t seed = 1; seed <= 12; ++seed)
        all.push_back({0, seed});
    for (const int jobs : {1, 3}) {
        std::vector<Finished> ended;
        Work work;
        work.jobs = jobs;
        work.play = [](const Task& t) -> std::string {
            if (t.seed == 3)
                std::raise(SIGKILL);
            if (t.seed == 5)
                ::_exit(9);
            if (t.seed == 7)
                throw std::runtime_error("no way");
            if (t.seed == 9)
                throw Stopped{};
            return std::string(static_cast<std::size_t>(t.seed) * 100'000, 'x'); // far more than a pipe holds
        };
        work.finished = [&](const Finished& f) {
            ended.push_back(f);
            return std::string();
        };
        REQUIRE(playAll(all, work).empty());
        REQUIRE(ended.size() == 11); // the one that was stopped is not finished
        for (const Finished& f : ended) {
            CHECK(f.signal == (f.task.seed == 3 ? SIGKILL : 0));
            CHECK(f.exitCode == (f.task.seed == 5 ? 9 : f.task.seed == 7 ? kThrew : 0));
            if (f.task.seed == 7)
                CHECK(f.result == "no way");
            else if (f.exitCode == 0 && f.signal == 0)
                CHECK(f.result.size() == static_cast<std::size_t>(f.task.seed) * 100'000);
        }
    }
}

TEST_CASE("work ends at once when results cannot be kept, and when it is interrupted") {
    std::vector<Task> all(20);
    Work work;
    work.jobs = 2;
    work.play = [](const Task&) { return std::string("x"); };
    int kept = 0;
    work.finished = [&](const Finished&) { return ++kept == 3 ? "disk full" : ""; };
    CHECK(playAll(all, work) == "disk full");
    CHECK(kept == 3);
    std::atomic<bool> stop{false};
    work.interrupt = &stop;
    work.play = [](const Task&) {
        ::pause(); // for ever: only a signal ends it
        return std::string();
    };
    work.turn = [&] { stop = true; };
    CHECK(playAll(all, work).empty());
    CHECK(kept == 3);
}
