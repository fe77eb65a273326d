#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/sweep/sweep_play.h"
#include "plugin/cli/sweep/sweep_work.h"
#include "plugin/cli/verbs.h"
#include "plugin/pages/sweep/sweep_page.h"

#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/statistics.h"
#include "plugin/lab/sweep/store.h"
#include "plugin/lab/sweep/table.h"
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
using Work = SweepWork;
using sweep::Definition;
using sweep::Finished;
using sweep::Store;
using sweep::StoredRun;
using sweep::Task;

int complain(int code, const std::string& message) {
    std::fprintf(stderr, "%s\n", message.c_str());
    return code;
}
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

/// Version and check sum (FNV-1a) of this program: digits are the same for the same program only.
std::string buildName() {
    std::uint64_t h = 14695981039346656037ULL;
    if (const auto program = record::readText("/proc/self/exe"))
        for (const char c : program.value)
            h = (h ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
    char text[64];
    std::snprintf(text, sizeof text, "%s %016llx", SC_VERSION, static_cast<unsigned long long>(h));
    return text;
}

/// At most one program at a time works in a folder; the lock goes with the process, however it ends.
class Lock {
public:
    std::string take(const std::string& folder) {
        const std::string path = folder + "/.lock";
        file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (file_ < 0)
            return path + ": " + std::strerror(errno);
        // Workers of a sweep that was killed a moment ago may hold it still.
        for (int i = 0; i < 50; ++i) {
            if (::flock(file_, LOCK_EX | LOCK_NB) == 0)
                return {};
            ::usleep(20'000);
        }
        return folder + ": another sweep is at work there";
    }
    void letGo() {
        if (file_ >= 0)
            ::close(file_);
        file_ = -1;
    }
    Lock() = default;
    ~Lock() { letGo(); }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

private:
    int file_ = -1;
};

/// Reads sweep and scene and looks whether every set can be started.
int prepare(const SweepArguments& a, Work& work) {
    auto loaded = loadSweep(a.file);
    if (!loaded)
        return kBadInput;
    work.sweep = std::move(*loaded);
    if (!a.seeds.empty())
        work.sweep.seeds = sweep::parseSeeds(a.seeds);
    if (work.sweep.seeds.empty())
        return badInput("--seeds " + a.seeds + ": expected seeds such as 1:20 or 1:5,8");
    if (a.engine == "slurm" && (!a.shard.empty() || !a.merge.empty()))
        return badInput("--engine slurm makes and merges shards itself; --shard and --merge are for doing it by hand");
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
    for (std::size_t set = 0; set < work.sweep.sets.size(); ++set)
        if (!canStart(work.sceneText, work.sweep.scene, work.sweep.settings(set)))
            return kBadInput;
    return kDone;
}

/// A store holds runs of one scene, and of one shard.
int checkIdentity(const SweepArguments& a, Work& work) {
    const std::string shard = std::to_string(work.shard.part) + "/" + std::to_string(work.shard.parts);
    const std::vector<std::pair<std::string, std::string>> wanted = {
        {"format", kSweepFormat}, {"scene", work.sceneText}, {"shard", shard}};
    const auto known = work.store.finished();
    if (!known)
        return cannotWrite(known.error);
    if (!known.value.empty() && !a.resume && a.merge.empty())
        return badInput(a.out + ": holds " + std::to_string(known.value.size()) +
                        " runs already; go on with --resume, or choose another folder with --out");
    for (const auto& [key, value] : wanted) {
        const auto there = work.store.meta(key);
        if (!there)
            return cannotWrite(there.error);
        if (!there.value.empty() && there.value != value && !known.value.empty())
            return badInput(a.out + ": " +
                            (key == "scene" ? "the scene was another one when these runs were played"
                             : key == "shard"
                                 ? "holds shard " + there.value + " of a sweep, give " + value + " a folder of its own"
                                 : "written by another version, " + there.value) +
                            "; choose another folder with --out");
        if (const std::string error = work.store.setMeta(key, value); !error.empty())
            return cannotWrite(error);
    }
    return kDone;
}

int mergeAll(const SweepArguments& a, Work& work) {
    for (const std::string& folder : a.merge) {
        const std::string path = folder + "/" + kSweepStore;
        std::error_code error;
        if (!fs::is_regular_file(path, error))
            return badInput(path + ": there is no such file; --merge takes folders of shards");
        Store shard;
        if (const std::string why = shard.open(path); !why.empty())
            return badInput(why);
        const auto format = shard.meta("format"), scene = shard.meta("scene");
        if (!format || !scene || format.value != kSweepFormat || scene.value != work.sceneText)
            return badInput(folder + ": holds runs of another scene or of another version");
        if (const std::string why = work.store.takeOver(shard); !why.empty())
            return cannotWrite(why);
    }
    return kDone;
}

StoredRun storedRun(const Definition& definition, const Finished& f, const std::string& host,
                    const std::string& build) {
    StoredRun run;
    run.parameters = sweep::keyOf(definition.settings(f.task.set));
    run.seed = f.task.seed;
    run.host = host;
    run.build = build;
    run.wall = f.wall;
    run.cpu = f.cpu;
    const auto result = f.exitCode == 0 && f.signal == 0 ? sweep::unpacked(f.result) : std::nullopt;
    if (result) {
        run.status = result->status;
        run.message = result->message;
        run.result = f.result;
        return run;
    }
    run.status = "crashed";
    run.message = f.signal != 0 ? std::string("its process was ended by signal ") + strsignal(f.signal)
                  : f.exitCode == sweep::kThrew && !f.result.empty()
                      ? f.result
                      : "its process ended with code " + std::to_string(f.exitCode);
    return run;
}

/// Plays what is missing.
std::string play(const SweepArguments& a, Work& work, Lock& lock) {
    const auto known = work.store.finished();
    if (!known)
        return known.error;
    std::vector<Task> missing;
    for (const Task& task : sweep::tasks(work.sweep, work.shard))
        if (known.value.count({sweep::keyOf(work.sweep.settings(task.set)), task.seed}) == 0)
            missing.push_back(task);
        else
            ++work.playedBefore;
    const std::string host = hostName(), build = buildName();
    ProgressLine line(a.quiet);
    std::size_t done = 0;
    std::string last;
    sweep::Work plan;
    plan.jobs = a.jobs;
    plan.interrupt = &interrupted;
    plan.play = [&](const Task& task) {
        return playOne(work.sceneText, work.sweep.scene, work.sweep.settings(task.set), task.seed);
    };
    plan.finished = [&](const Finished& f) {
        const StoredRun run = storedRun(work.sweep, f, host, build);
        ++done;
        work.died += run.status == "crashed" ? 1 : 0;
        work.failed += run.status == "failed" ? 1 : 0;
        last = run.parameters + ", seed " + std::to_string(run.seed);
        return work.store.keep(run);
    };
    std::size_t shown = 0;
    plan.turn = [&] {
        if (done == shown && ::isatty(STDERR_FILENO) == 0) // plain lines: only where there is news
            return;
        shown = done;
        const std::string bad =
            work.died + work.failed > 0 ? ", " + std::to_string(work.died + work.failed) + " not good" : "";
        line.show(static_cast<double>(done) / static_cast<double>(missing.size()),
                  "run " + std::to_string(done) + " of " + std::to_string(missing.size()) + bad +
                      (last.empty() ? "" : " (" + last + ")"));
    };
    plan.child = [&] { lock.letGo(); };
    return sweep::playAll(missing, plan);
}

void say(const SweepArguments& a, Work& work, const sweep::Table& table) {
    std::size_t& missing = work.missing;
    for (const Task& task : sweep::tasks(work.sweep, {}))
        missing += std::none_of(table.rows.begin(), table.rows.end(),
                                [&](const sweep::Row& r) { return r.set == task.set && r.seed == task.seed; })
                       ? 1
                       : 0;
    if (!a.quiet) {
        std::printf("%zu runs of %zu sets of parameters%s\n", table.rows.size(), work.sweep.sets.size(),
                    missing > 0 ? (", " + std::to_string(missing) + " still to be played").c_str() : "");
        std::printf("results: %s/results.csv, statistics.csv, timings.csv, failed.csv, %s\n", a.out.c_str(),
                    kSweepStore);
        std::printf("pictures: %s/report.html\n", a.out.c_str());
    }
    for (const sweep::Row& row : table.rows)
        if (row.status != "done")
            std::fprintf(stderr, "%s: %s: %s\n  again alone: %s\n", sweep::keyOf(work.sweep.settings(row.set)).c_str(),
                         row.status.c_str(), row.message.c_str(),
                         sweep::commandOf(work.sweep, row.set, row.seed).c_str());
}

int finish(const SweepArguments& a, Work& work) {
    const auto table = sweep::collect(work.sweep, work.store);
    if (!table)
        return cannotWrite(table.error);
    std::vector<record::NamedText> files = {{"results.csv", sweep::resultsCsv(work.sweep, table.value)},
                                            {"statistics.csv", sweep::statisticsCsv(work.sweep, table.value)},
                                            {"timings.csv", sweep::timingsCsv(work.sweep, table.value)},
                                            {"failed.csv", sweep::failedCsv(work.sweep, table.value)}};
    if (std::string cycles = sweep::cyclesCsv(work.sweep, table.value); !cycles.empty())
        files.emplace_back("cycles.csv", std::move(cycles));
    auto pages = sweepPages(work.sweep, table.value, work.store);
    if (!pages)
        return cannotWrite(pages.error);
    std::move(pages.value.begin(), pages.value.end(), std::back_inserter(files));
    if (const std::string error = record::writeAtomically(a.out, files); !error.empty())
        return cannotWrite(error);
    say(a, work, table.value);
    const bool arrived = printed();
    const bool good = std::all_of(table.value.rows.begin(), table.value.rows.end(),
                                  [](const sweep::Row& r) { return r.status == "done"; });
    const bool ended = a.engine != "slurm" || interrupted || work.missing == 0;
    if (!ended)
        std::fprintf(stderr, "%zu runs did not arrive; what the tasks said is in %s/slurm, --resume plays them\n",
                     work.missing, a.out.c_str());
    return !arrived ? kCannotWrite : good && ended ? kDone : kCannotGoOn;
}

} // namespace

int sweep(const SweepArguments& a) {
    Work work;
    if (const int code = prepare(a, work); code != kDone)
        return code;
    Folder folder(a.out);
    if (const std::string error = folder.prepare(); !error.empty())
        return cannotWrite(error);
    Lock lock;
    if (const std::string error = lock.take(a.out); !error.empty())
        return cannotWrite(error);
    if (const std::string error = work.store.open(a.out + "/" + kSweepStore); !error.empty())
        return cannotWrite(error);
    if (const int code = checkIdentity(a, work); code != kDone)
        return code;
    if (const int code = mergeAll(a, work); code != kDone)
        return code;
    if (a.merge.empty() && a.engine == "slurm") {
        if (const std::string error = playOnCluster(a, work); !error.empty())
            return complain(kCannotGoOn, error);
    } else if (a.merge.empty()) {
        if (const std::string error = play(a, work, lock); !error.empty())
            return cannotWrite(error);
    }
    const int code = finish(a, work);
    if (interrupted && code != kCannotWrite) {
        std::fprintf(stderr, "interrupted; what is done is in %s, --resume goes on\n", a.out.c_str());
        return kInterrupted;
    }
    return code;
}

} // namespace supercircle::cli
