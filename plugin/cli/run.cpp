#include "plugin/cli/input.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/verbs.h"

#include "bridge/lab_world.h"
#include "plugin/lab/runner.h"
#include "plugin/record/writer.h"
#include "plugin/report/report.h"
#include "supercircle/coulomb/dump.h"

#include <cstdio>
#include <filesystem>
#include <unistd.h>

namespace supercircle::cli {

namespace {

namespace fs = std::filesystem;

/// Makes the folder and proves that it can be written, before any work is done.
std::string prepareFolder(const std::string& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        return "cannot make the folder " + folder + ": " + error.message();
    if (!fs::is_directory(folder))
        return folder + " is not a folder";
    if (access(folder.c_str(), W_OK) != 0)
        return "the folder " + folder + " is not writable; choose another with --out";
    const fs::path probe = fs::path(folder) / ".supercircle-write-test";
    std::FILE* f = std::fopen(probe.c_str(), "w");
    if (!f)
        return "cannot write into " + folder + "; choose another with --out";
    std::fclose(f);
    fs::remove(probe, error);
    return {};
}

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
    for (const auto& [key, value] : r.summary)
        if (key.rfind("stage_", 0) != 0)
            std::printf("  %-26s %s\n", key.c_str(), text(value).c_str());
    std::printf("results: %s/summary.json, series.csv\n", folder.c_str());
    if (pictures)
        std::printf("pictures: %s/report.html (or overview.png, force.png)\n", folder.c_str());
}

} // namespace

int run(const RunArguments& a) {
    const auto scene = loadScene(a.scene, a.parameters);
    if (!scene)
        return kBadInput;
    std::string why;
    std::shared_ptr<step::HostWorld> host = bridge::makeWorld(scene->rigid, why);
    if (!host) {
        std::fprintf(stderr, "%s: %s\n", a.scene.c_str(), why.c_str());
        return kBadInput;
    }
    const std::string folder = a.out.empty() ? "out/" + fs::path(a.scene).stem().string() : a.out;
    if (const std::string error = prepareFolder(folder); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    ProgressLine line(a.quiet);
    lab::Options options;
    options.seed = a.seed;
    options.threads = a.threads;
    options.fixedDt = a.fixedDt;
    options.frames = !a.noReport;
    options.interrupt = &interrupted;
    options.progress = [&](const lab::Progress& p) { line.show(p); };
    std::uint64_t dumped = 0;
    if (!a.dump.empty()) {
        if (const std::string error = prepareFolder(a.dump); !error.empty()) {
            std::fprintf(stderr, "%s\n", error.c_str());
            return kCannotWrite;
        }
        options.onSolve = [&](const coulomb::Problem& p, const coulomb::SolveReport&) {
            char name[32];
            std::snprintf(name, sizeof name, "/%06llu.fcp", static_cast<unsigned long long>(dumped++));
            if (const std::string error = coulomb::writeDump(a.dump + name, p); !error.empty())
                std::fprintf(stderr, "%s\n", error.c_str());
        };
    }
    const lab::Outcome out = lab::run(*scene, host, options);
    if (out.end == lab::End::BadScene) {
        std::fprintf(stderr, "%s: %s\n", a.scene.c_str(), out.message.c_str());
        return kBadInput;
    }
    std::string error = record::writeFiles(out.recording, folder);
    if (error.empty() && !a.noReport)
        error = report::writeReport(out.recording, folder);
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (!a.quiet)
        printSummary(out.recording, folder, !a.noReport);
    if (out.end == lab::End::Failed) {
        std::fprintf(stderr, "the simulation could not go on: %s; the last good state is in %s\n", out.message.c_str(),
                     folder.c_str());
        return kCannotGoOn;
    }
    return out.end == lab::End::Interrupted ? kInterrupted : kDone;
}

} // namespace supercircle::cli
