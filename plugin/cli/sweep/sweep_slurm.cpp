// The engine `slurm`: shards as tasks of a job array (decision 0176). Every task is the subcommand `sweep` with its own
// shard and folder. The name of the array is derived from the folder: a sweep that is resumed finds an array that still
// runs.

#include "plugin/cli/progress.h"
#include "plugin/cli/sweep/sweep_work.h"

#include "plugin/lab/sweep/slurm.h"
#include "plugin/recording/table/files.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <unistd.h>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;
using sweep::ArrayJob;
using sweep::ResultStore;
using sweep::RunName;
using sweep::Task;

std::string shardsOf(const std::string& folder) {
    return folder + "/shards";
}

std::string shardFolder(const std::string& folder, int part, int parts) {
    return shardsOf(folder) + "/" + std::to_string(part) + "_of_" + std::to_string(parts);
}

RunName nameOf(const SweepWork& work, const Task& task) {
    return {sweep::keyOf(work.sweep.parameterValues(task.set)), task.seed};
}

/// Merges the results of all shards, of this array and of earlier ones.
std::string mergeShards(const std::string& folder, SweepWork& work) {
    std::error_code error;
    std::vector<std::string> paths;
    for (const auto& entry : fs::directory_iterator(shardsOf(folder), error))
        paths.push_back(entry.path().string() + "/" + sweep::kStoreFile);
    std::sort(paths.begin(), paths.end());
    for (const std::string& path : paths) {
        if (!fs::is_regular_file(path, error))
            continue;
        ResultStore shard;
        if (std::string why = shard.open(path); !why.empty())
            return why;
        if (std::string why = work.store.mergeFrom(shard); !why.empty())
            return why;
    }
    return {};
}

/// Gives the shards the runs that are known already, so that they do not repeat them.
std::string prepareShards(const std::string& folder, int parts, SweepWork& work) {
    const auto known = work.store.finished();
    if (!known)
        return known.error();
    for (int part = 1; part <= parts; ++part) {
        std::set<RunName> theirs;
        for (const Task& task : sweep::tasks(work.sweep, {part, parts}))
            if (known->count(nameOf(work, task)) > 0)
                theirs.insert(nameOf(work, task));
        if (theirs.empty())
            continue;
        const std::string path = shardFolder(folder, part, parts);
        std::error_code error;
        fs::create_directories(path, error);
        ResultStore shard;
        std::string why = shard.open(path + "/" + sweep::kStoreFile);
        for (const auto& [key, value] : {std::pair<std::string, std::string>{"format", sweep::kStoreFormat},
                                         {"scene", work.sceneText},
                                         {"shard", std::to_string(part) + "/" + std::to_string(parts)}})
            if (why.empty())
                why = shard.setMeta(key, value);
        if (why.empty())
            why = shard.mergeFrom(work.store, theirs);
        if (!why.empty())
            return why;
    }
    return {};
}

Result<ArrayJob> submit(const SweepArguments& a, const std::string& folder, const std::string& name) {
    using Out = Result<ArrayJob>;
    const std::string program = fs::read_symlink("/proc/self/exe").string();
    std::vector<std::string> command = {program,
                                        "sweep",
                                        fs::absolute(a.file).string(),
                                        "--out",
                                        shardsOf(folder) + "/@TASK@_of_@TASKS@",
                                        "--shard",
                                        "@TASK@/@TASKS@",
                                        "--jobs",
                                        "1",
                                        "--resume"};
    if (!a.seeds.empty())
        command.insert(command.end(), {"--seeds", a.seeds});
    if (!a.accuracy.empty())
        command.insert(command.end(), {"--accuracy", a.accuracy});
    const std::string script = sweep::arrayScript(command, a.jobs, folder + "/slurm/%a.log");
    if (std::string error = record::writeAtomically(folder + "/slurm", {{"job.sh", script}}).error(); !error.empty())
        return Out::failure(error);
    const auto id = sweep::submitArray(folder + "/slurm/job.sh", name, a.jobs, a.slurmOptions);
    return id ? Out(ArrayJob{*id, name + std::to_string(a.jobs), a.jobs}) : Out::failure(id.error());
}

/// Number of runs finished by the tasks of an array, from their progress lines; their stores stay locked until they
/// end.
std::size_t finishedRuns(const std::string& folder, int parts) {
    std::size_t all = 0;
    for (int part = 1; part <= parts; ++part) {
        const auto log = record::readText(folder + "/slurm/" + std::to_string(part) + ".log");
        const std::size_t at = log ? log->rfind("run ") : std::string::npos; // "  5 %  run 3 of 60 (...)"
        if (at != std::string::npos)
            all += static_cast<std::size_t>(std::strtoull(log->c_str() + at + 4, nullptr, 10));
    }
    return all;
}

std::string wait(const SweepArguments& a, const std::string& folder, const ArrayJob& job, std::size_t missing) {
    ProgressLine line(a.quiet);
    while (!interrupted) {
        const auto there = sweep::findArray(job.name);
        if (!there)
            return there.error();
        if (!*there)
            return {};
        const std::size_t done = std::min(missing, finishedRuns(folder, job.parts));
        line.show(static_cast<double>(done) / static_cast<double>(missing),
                  "run " + std::to_string(done) + " of " + std::to_string(missing) + " (array job " + job.id + ")");
        ::usleep(a.jobs > 16 ? 3'000'000 : 500'000); // limits the load of the Slurm controller
    }
    line.clear();
    std::fprintf(stderr, "array job %s continues; `scancel %s` ends it\n", job.id.c_str(), job.id.c_str());
    return {};
}

} // namespace

std::string runOnCluster(const SweepArguments& a, SweepWork& work) {
    const std::string folder = fs::canonical(a.out).string();
    const std::string name = sweep::arrayName(folder);
    if (std::string error = mergeShards(folder, work); !error.empty())
        return error;
    const auto known = work.store.finished();
    if (!known)
        return known.error();
    const std::vector<Task> tasks = sweep::tasks(work.sweep, {});
    const auto missing = static_cast<std::size_t>(
        std::count_if(tasks.begin(), tasks.end(), [&](const Task& t) { return known->count(nameOf(work, t)) == 0; }));
    if (missing == 0)
        return {};
    const auto there = sweep::findArray(name);
    if (!there)
        return there.error();
    ArrayJob job = there->value_or(ArrayJob{});
    if (!*there) {
        if (std::string error = prepareShards(folder, a.jobs, work); !error.empty())
            return error;
        const auto submitted = submit(a, folder, name);
        if (!submitted)
            return submitted.error();
        job = *submitted;
    }
    if (std::string error = wait(a, folder, job, missing); !error.empty())
        return error;
    return mergeShards(folder, work);
}

} // namespace supercircle::cli
