#include "plugin/cli/build_name.h"
#include "plugin/cli/command_line.h"
#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/subcommands.h"

#include "plugin/lab/session/checkpoint.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/pages/run/report.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/text.h"
#include "plugin/recording/table/writer.h"
#include "supercircle/coulomb/dump.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;

int cannotWrite(const std::string& error) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return kCannotWrite;
}

/// Writes every contact problem of the run to a file. The first failure stops the run.
class ProblemDump {
public:
    explicit ProblemDump(std::string path) : folder_(std::move(path)) {}

    std::string prepare() { return folder_.prepare(); }
    [[nodiscard]] const std::string& error() const { return error_; }

    void write(const coulomb::Problem& problem) {
        if (!error_.empty())
            return;
        char name[32];
        std::snprintf(name, sizeof name, "/%06llu.fcp", count_++);
        const std::string path = folder_.path() + name;
        error_ = coulomb::writeDump(path, problem);
        if (error_.empty())
            return;
        std::error_code ignored; // an incomplete file is removed
        fs::remove(path, ignored);
        interrupted = true;
    }

private:
    OutputFolder folder_;
    std::string error_;
    unsigned long long count_ = 0;
};

std::string text(const record::Value& v) {
    if (const auto* d = std::get_if<double>(&v)) {
        char buffer[32];
        std::snprintf(buffer, sizeof buffer, "%.4g", *d);
        return buffer;
    }
    if (const auto* i = std::get_if<std::int64_t>(&v))
        return std::to_string(*i);
    if (const auto* b = std::get_if<bool>(&v))
        return *b ? "true" : "false";
    return std::get<std::string>(v);
}

void printSummary(const record::Recording& r, const std::string& folder, bool pictures) {
    const auto line = [](const std::string& key, const record::Value& value) {
        std::printf("  %-34s %s\n", key.c_str(), text(value).c_str());
    };
    for (const auto& [key, value] : r.summary)
        line(key, value);
    for (const auto& [key, seconds] : r.timing)
        if (key.rfind("stage_", 0) != 0)
            line(key, seconds);
    std::printf("results: %s/summary.json, series.csv\n", folder.c_str());
    if (pictures)
        std::printf("pictures: %s/report.html (without a browser: overview.png)\n", folder.c_str());
}

/// Writes all files or none; without a report, that of an earlier run is removed.
std::string writeAll(const record::Recording& recording, const std::string& folder, bool report) {
    auto files = record::recordingFiles(recording);
    if (!files)
        return files.error();
    std::string reportError;
    if (report) {
        auto pictures = pages::reportFiles(recording);
        reportError = pictures.error();
        if (pictures)
            std::move(pictures->begin(), pictures->end(), std::back_inserter(*files));
    }
    if (const std::string error = record::writeAtomically(folder, *files).error(); !error.empty())
        return error;
    const std::string old = pages::removeOldReport(folder, *files);
    return reportError.empty() ? old : reportError;
}

std::string numberText(double value) {
    std::string out;
    record::appendNumber(out, value);
    return out;
}

/// What decides the numbers of the run. Threads do not.
lab::RunIdentity identityOf(const RunArguments& a, const scene::Scene& scene) {
    const auto text = record::readText(a.scene);
    lab::RunIdentity identity{{"program", buildName()},
                              {"text of the scene", checksum(text ? *text : std::string{})},
                              {"--seed", std::to_string(a.seed)},
                              {"--fixed-dt", numberText(a.fixedDt)},
                              {"--accuracy", a.accuracy.empty() ? "of the scene" : a.accuracy}};
    for (const scene::Parameter& p : scene.parameters)
        identity.emplace_back("parameter " + p.name, numberText(p.value));
    return identity;
}

/// Checkpoints of the run and the state to continue from; the exit code where the run must not start, else kDone.
int prepareCheckpoint(const RunArguments& a, const scene::Scene& scene, const lab::CheckpointFile& file,
                      lab::CheckpointOptions& options) {
    if (a.checkpoint <= 0.0 && !a.resume)
        return kDone;
    if (const std::string why = lab::whyNoCheckpoint(scene); !why.empty())
        return complain(kBadInput, a.scene + ": " + why + "; run it without --checkpoint and --resume");
    options.file = &file;
    if (a.checkpoint > 0.0)
        options.interval = a.checkpoint;
    options.onFailure = [](const std::string& why) {
        std::fprintf(stderr, "warning: no checkpoint was written: %s; the run goes on\n", why.c_str());
    };
    if (!a.resume)
        return file.exists()
                   ? complain(kBadInput, file.path() + " is the checkpoint of a run that was interrupted; continue it "
                                                       "with --resume, or remove the file to begin anew")
                   : kDone;
    if (!file.exists()) {
        std::fprintf(stderr, "there is no checkpoint %s: the run starts from the beginning\n", file.path().c_str());
        return kDone;
    }
    auto state = file.read();
    if (!state)
        return complain(kBadInput, state.error());
    options.resume = *std::move(state);
    return kDone;
}

} // namespace

int run(const RunArguments& a) {
    const auto input = loadScene(a.scene, a.parameters, a.quiet);
    if (!input)
        return kBadInput;
    OutputFolder folder(a.out.empty() ? "out/" + fs::path(a.scene).stem().string() : a.out);
    if (const std::string error = folder.prepare(); !error.empty())
        return cannotWrite(error);
    ProblemDump dump(a.dump);
    if (!a.dump.empty())
        if (const std::string error = dump.prepare(); !error.empty())
            return cannotWrite(error);
    ProgressLine line(a.quiet);
    lab::RunOptions options;
    options.seed = static_cast<std::uint64_t>(a.seed);
    options.threads = a.threads;
    options.fixedDt = a.fixedDt;
    options.accuracy = accuracyOf(a.accuracy);
    options.interrupt = &interrupted;
    options.progress = [&](const lab::RunProgress& p) { line.show(p); };
    if (!a.dump.empty())
        options.onSolve = [&](const coulomb::Problem& p, const coulomb::SolveReport&) { dump.write(p); };
    const bool kept = a.checkpoint > 0.0 || a.resume;
    const lab::CheckpointFile checkpoint(folder.path(), kept ? identityOf(a, input->scene) : lab::RunIdentity{});
    if (const int code = prepareCheckpoint(a, input->scene, checkpoint, options.checkpoint); code != kDone)
        return code;
    const lab::RunResult out = lab::runScene(input->scene, input->host, options);
    line.clear();
    if (out.status == lab::RunStatus::BadScene) {
        std::fprintf(stderr, "%s: %s\n", a.scene.c_str(), out.message.c_str());
        return kBadInput;
    }
    if (const std::string error = writeAll(out.recording, folder.path(), !a.noReport); !error.empty())
        return cannotWrite(error);
    if (!dump.error().empty())
        return cannotWrite(dump.error());
    if (!a.quiet)
        printSummary(out.recording, folder.path(), !a.noReport);
    const bool wasPrinted = printed();
    if (out.status == lab::RunStatus::Failed) {
        std::fprintf(stderr, "the simulation could not go on: %s; the last valid state is in %s\n", out.message.c_str(),
                     folder.path().c_str());
        return kCannotGoOn;
    }
    if (out.status == lab::RunStatus::Interrupted) {
        std::fprintf(stderr, "interrupted; what is done is in %s%s\n", folder.path().c_str(),
                     checkpoint.exists() && options.checkpoint.file ? "; --resume continues" : "");
        return kInterrupted;
    }
    return wasPrinted ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
