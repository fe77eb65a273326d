#include "plugin/cli/build_name.h"
#include "plugin/cli/command_line.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/subcommands.h"
#include "plugin/cli/sweep/sweep_input.h"
#include "plugin/cli/sweep/sweep_run.h"
#include "plugin/cli/sweep/sweep_work.h"
#include "plugin/pages/sweep/sweep_page.h"

#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/result_store.h"
#include "plugin/lab/sweep/run_table.h"
#include "plugin/lab/sweep/statistics.h"
#include "plugin/lab/sweep/workers.h"
#include "plugin/recording/table/files.h"
#include "plugin/scene/loader/document.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <unistd.h>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;
using sweep::FinishedTask;
using sweep::ResultStore;
using sweep::StoredRun;
using sweep::SweepDefinition;
using sweep::Task;

int badInput(const std::string& message) {
    return complain(kBadInput, message);
}
int cannotWrite(const std::string& message) {
    return complain(kCannotWrite, message);
}

std::string hostName() {
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// Lets at most one program at a time work in a folder. The lock ends with the process.
class FolderLock {
public:
    std::string acquire(const std::string& folder) {
        const std::string path = folder + "/.lock";
        file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (file_ < 0)
            return path + ": " + std::strerror(errno);
        // Workers of a sweep that was just killed may still hold it.
        for (int i = 0; i < 50; ++i) {
            if (::flock(file_, LOCK_EX | LOCK_NB) == 0)
                return {};
            ::usleep(20'000);
        }
        return folder + ": another sweep is running there";
    }
    void release() {
        if (file_ >= 0)
            ::close(file_);
        file_ = -1;
    }
    FolderLock() = default;
    ~FolderLock() { release(); }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int file_ = -1;
};

/// Reads sweep and scene and checks whether every set can be started.
int prepare(const SweepArguments& a, SweepWork& work) {
    auto loaded = loadSweep(a.file);
    if (!loaded)
        return kBadInput;
    work.sweep = std::move(*loaded);
    if (!a.seeds.empty())
        work.sweep.seeds = sweep::parseSeeds(a.seeds);
    if (work.sweep.seeds.empty())
        return badInput("--seeds " + a.seeds + ": expected seeds such as 1:20 or 1:5,8");
    if (a.engine == "slurm" && (!a.shard.empty() || !a.merge.empty()))
        return badInput("--engine slurm creates and merges the shards; do not give --shard or --merge");
    if (!a.shard.empty()) {
        const auto shard = sweep::parseShard(a.shard);
        if (!shard)
            return badInput("--shard " + a.shard + ": expected I/N with 1 <= I <= N, for example 1/4");
        work.shard = *shard;
    }
    std::vector<scene::Problem> problems;
    const auto text = scene::readFile(work.sweep.scene, problems);
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (!text)
        return kBadInput;
    work.sceneText = *text;
    work.sweep.accuracy = a.accuracy;
    for (std::size_t set = 0; set < work.sweep.sets.size(); ++set)
        if (!canStart(work.sceneText, work.sweep.scene, work.sweep.parameterValues(set)))
            return kBadInput;
    return kDone;
}

const std::string kOfScene = "of the scene"; ///< accuracy that no option gives

/// A store holds runs of one scene, of one shard and of one accuracy.
int checkIdentity(const SweepArguments& a, SweepWork& work) {
    const std::string shard = std::to_string(work.shard.part) + "/" + std::to_string(work.shard.parts);
    if (const std::string error = work.store.checkFormat(); !error.empty())
        return badInput(error);
    const std::vector<std::pair<std::string, std::string>> wanted = {
        {"format", sweep::kStoreFormat},
        {"scene", work.sceneText},
        {"shard", shard},
        {"accuracy", a.accuracy.empty() ? kOfScene : a.accuracy}};
    const auto known = work.store.finished();
    if (!known)
        return cannotWrite(known.error());
    if (!known->empty() && !a.resume && a.merge.empty())
        return badInput(a.out + ": holds " + std::to_string(known->size()) +
                        " runs already; continue with --resume, or choose another folder with --out");
    for (const auto& [key, value] : wanted) {
        const auto there = work.store.meta(key);
        if (!there)
            return cannotWrite(there.error());
        const std::string stored = there->empty() && key == "accuracy" ? kOfScene : *there;
        if (!stored.empty() && stored != value && !known->empty())
            return badInput(a.out + ": " +
                            (key == "scene"      ? "these runs are of another version of the scene"
                             : key == "accuracy" ? "these runs have another accuracy: " + stored
                                                 : "holds shard " + *there + " of a sweep, not shard " + value) +
                            "; choose another folder with --out");
        if (const std::string error = work.store.setMeta(key, value); !error.empty())
            return cannotWrite(error);
    }
    return kDone;
}

int mergeAll(const SweepArguments& a, SweepWork& work) {
    for (const std::string& folder : a.merge) {
        const std::string path = folder + "/" + sweep::kStoreFile;
        std::error_code error;
        if (!fs::is_regular_file(path, error))
            return badInput(path + ": there is no such file; --merge takes folders of shards");
        ResultStore shard;
        if (const std::string why = shard.open(path); !why.empty())
            return badInput(why);
        if (const std::string why = shard.checkFormat(); !why.empty())
            return badInput(why);
        const auto scene = shard.meta("scene");
        if (!scene || *scene != work.sceneText)
            return badInput(folder + ": holds runs of another scene");
        const auto accuracy = shard.meta("accuracy"), ours = work.store.meta("accuracy");
        if (!accuracy || !ours || (accuracy->empty() ? kOfScene : *accuracy) != *ours)
            return badInput(folder + ": holds runs of another accuracy; give the same --accuracy");
        if (const std::string why = work.store.mergeFrom(shard); !why.empty())
            return cannotWrite(why);
    }
    return kDone;
}

StoredRun storedRun(const SweepDefinition& definition, const FinishedTask& f, const std::string& host,
                    const std::string& build) {
    StoredRun run;
    run.parameters = sweep::keyOf(definition.parameterValues(f.task.set));
    run.seed = f.task.seed;
    run.host = host;
    run.build = build;
    run.wall = f.wall;
    run.cpu = f.cpu;
    const auto result = f.exitCode == 0 && f.signal == 0 ? sweep::deserialise(f.result) : std::nullopt;
    if (result) {
        run.status = result->status;
        run.message = result->message;
        run.result = f.result;
        return run;
    }
    run.status = "crashed";
    run.message = f.signal != 0 ? std::string("its process was ended by signal ") + strsignal(f.signal)
                  : f.exitCode == sweep::kExitException && !f.result.empty()
                      ? f.result
                      : "its process ended with code " + std::to_string(f.exitCode);
    return run;
}

/// Runs what is missing.
std::string runMissing(const SweepArguments& a, SweepWork& work, FolderLock& lock) {
    const auto known = work.store.finished();
    if (!known)
        return known.error();
    std::vector<Task> missing;
    for (const Task& task : sweep::tasks(work.sweep, work.shard))
        if (known->count({sweep::keyOf(work.sweep.parameterValues(task.set)), task.seed}) == 0)
            missing.push_back(task);
        else
            ++work.knownBefore;
    const std::string host = hostName(), build = buildName();
    ProgressLine line(a.quiet);
    std::size_t done = 0;
    std::string last;
    sweep::WorkPlan plan;
    plan.jobs = a.jobs;
    plan.interrupt = &interrupted;
    plan.runTask = [&](const Task& task) {
        return runOne(work.sceneText, work.sweep.scene, work.sweep.parameterValues(task.set), task.seed,
                      accuracyOf(a.accuracy));
    };
    plan.onFinished = [&](const FinishedTask& f) {
        const StoredRun run = storedRun(work.sweep, f, host, build);
        ++done;
        work.crashed += run.status == "crashed" ? 1 : 0;
        work.failed += run.status == "failed" ? 1 : 0;
        last = run.parameters + ", seed " + std::to_string(run.seed);
        return work.store.save(run);
    };
    std::size_t shown = 0;
    plan.onPoll = [&] {
        if (done == shown && ::isatty(STDERR_FILENO) == 0) // plain lines: only after a change
            return;
        shown = done;
        const std::string bad =
            work.crashed + work.failed > 0 ? ", " + std::to_string(work.crashed + work.failed) + " failed" : "";
        line.show(static_cast<double>(done) / static_cast<double>(missing.size()),
                  "run " + std::to_string(done) + " of " + std::to_string(missing.size()) + bad +
                      (last.empty() ? "" : " (" + last + ")"));
    };
    plan.onFork = [&] { lock.release(); };
    return sweep::runTasks(missing, plan);
}

void printResults(const SweepArguments& a, SweepWork& work, const sweep::RunTable& table) {
    std::size_t& missing = work.missing;
    for (const Task& task : sweep::tasks(work.sweep, {}))
        missing += std::none_of(table.rows.begin(), table.rows.end(),
                                [&](const sweep::Row& r) { return r.set == task.set && r.seed == task.seed; })
                       ? 1
                       : 0;
    if (!a.quiet) {
        std::printf("%zu runs of %zu sets of parameters%s\n", table.rows.size(), work.sweep.sets.size(),
                    missing > 0 ? (", " + std::to_string(missing) + " still to be run").c_str() : "");
        std::printf("results: %s/results.csv, statistics.csv, timings.csv, failed.csv, %s\n", a.out.c_str(),
                    sweep::kStoreFile);
        std::printf("pictures: %s/report.html\n", a.out.c_str());
    }
    for (const sweep::Row& row : table.rows)
        if (row.status != "done")
            std::fprintf(stderr, "%s: %s: %s\n  repeat it alone: %s\n",
                         sweep::keyOf(work.sweep.parameterValues(row.set)).c_str(), row.status.c_str(),
                         row.message.c_str(), sweep::commandOf(work.sweep, row.set, row.seed).c_str());
}

int finish(const SweepArguments& a, SweepWork& work) {
    const auto table = sweep::collect(work.sweep, work.store);
    if (!table)
        return cannotWrite(table.error());
    std::vector<record::NamedText> files = {{"results.csv", sweep::resultsCsv(work.sweep, *table)},
                                            {"statistics.csv", sweep::statisticsCsv(work.sweep, *table)},
                                            {"timings.csv", sweep::timingsCsv(work.sweep, *table)},
                                            {"failed.csv", sweep::failedCsv(work.sweep, *table)}};
    if (std::string cycles = sweep::cyclesCsv(work.sweep, *table); !cycles.empty())
        files.emplace_back("cycles.csv", std::move(cycles));
    auto made = pages::sweepPages(work.sweep, *table, work.store);
    if (!made)
        return cannotWrite(made.error());
    std::move(made->begin(), made->end(), std::back_inserter(files));
    if (const std::string error = record::writeAtomically(a.out, files).error(); !error.empty())
        return cannotWrite(error);
    printResults(a, work, *table);
    const bool wasPrinted = printed();
    const bool allDone =
        std::all_of(table->rows.begin(), table->rows.end(), [](const sweep::Row& r) { return r.status == "done"; });
    const bool ended = a.engine != "slurm" || interrupted || work.missing == 0;
    if (!ended)
        std::fprintf(stderr, "%zu runs are missing; the output of the tasks is in %s/slurm, --resume runs them again\n",
                     work.missing, a.out.c_str());
    return !wasPrinted ? kCannotWrite : allDone && ended ? kDone : kCannotGoOn;
}

} // namespace

int sweep(const SweepArguments& a) {
    SweepWork work;
    if (const int code = prepare(a, work); code != kDone)
        return code;
    OutputFolder folder(a.out);
    if (const std::string error = folder.prepare(); !error.empty())
        return cannotWrite(error);
    FolderLock lock;
    if (const std::string error = lock.acquire(a.out); !error.empty())
        return cannotWrite(error);
    if (const std::string error = work.store.open(a.out + "/" + sweep::kStoreFile); !error.empty())
        return cannotWrite(error);
    if (const int code = checkIdentity(a, work); code != kDone)
        return code;
    if (const int code = mergeAll(a, work); code != kDone)
        return code;
    if (a.merge.empty() && a.engine == "slurm") {
        if (const std::string error = runOnCluster(a, work); !error.empty())
            return complain(kCannotGoOn, error);
    } else if (a.merge.empty()) {
        if (const std::string error = runMissing(a, work, lock); !error.empty())
            return cannotWrite(error);
    }
    const int code = finish(a, work);
    if (interrupted && code != kCannotWrite) {
        std::fprintf(stderr, "interrupted; what is done is in %s, --resume continues\n", a.out.c_str());
        return kInterrupted;
    }
    return code;
}

} // namespace supercircle::cli
