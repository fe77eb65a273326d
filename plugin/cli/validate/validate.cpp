#include "bridge/box2d/lab_world.h"
#include "plugin/cli/data_folders.h"
#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"
#include "plugin/lab/validation/validation.h"
#include "plugin/pages/validation/validation_page.h"

#include <array>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace supercircle::cli {

namespace {

/// Names of 0.1.
constexpr std::array<std::pair<const char*, const char*>, 11> kFormerNames{{{"T1", "snap_boundary"},
                                                                            {"T2", "shell_on_cylinder"},
                                                                            {"T2s", "shell_on_cylinder_stuck"},
                                                                            {"T3", "two_shells"},
                                                                            {"T4", "gravity_sag"},
                                                                            {"T5", "plates"},
                                                                            {"T6", "statics"},
                                                                            {"T7", "pinning"},
                                                                            {"T8", "closed_forms"},
                                                                            {"T8c", "capstan"},
                                                                            {"T9", "grip"}}};

std::string currentName(const std::string& filter) {
    for (const auto& [old, now] : kFormerNames)
        if (filter == old) {
            std::fprintf(stderr,
                         "warning: the experiment %s is called %s since 0.2; the old name will be removed in 0.3\n",
                         old, now);
            return now;
        }
    return filter;
}

int explainFilter(const std::string& filter) {
    std::fprintf(stderr, "no validation experiment matches \"%s\"; there are:\n", filter.c_str());
    for (const validation::ExperimentDefinition& d : validation::experiments())
        std::fprintf(stderr, "  %-24s %s\n", d.id.c_str(), d.title.c_str());
    return kBadInput;
}

} // namespace

int validate(const ValidateArguments& a) {
    if (std::error_code none; !std::filesystem::is_directory(a.data, none)) {
        std::fprintf(stderr, "the folder of the reference curves %s does not exist; set it with --data\n",
                     a.data.c_str());
        return kBadInput;
    }
    OutputFolder folder(a.out);
    if (const std::string error = folder.prepare(); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    validation::ValidationSettings settings;
    settings.host = [](const step::RigidWorldDefinition& definition, std::string& error) {
        return std::shared_ptr<step::HostWorld>(bridge::makeWorld(definition, error));
    };
    settings.scenes = scenesFolder();
    settings.data = a.data;
    settings.quick = a.quick;
    settings.filter = currentName(a.filter);
    settings.jobs = a.jobs;
    settings.interrupt = &interrupted;
    settings.progress = [](const std::string& line) {
        std::printf("%s\n", line.c_str());
        std::fflush(stdout);
    };
    const std::vector<validation::ValidationExperiment> all = validation::runAll(settings);
    if (all.empty())
        return explainFilter(a.filter);
    const auto files = pages::validationFiles(all, settings);
    const std::string error = files ? record::writeAtomically(folder.path(), *files).error() : files.error();
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    const int missed = validation::unexpectedMisses(all);
    if (interrupted)
        std::fprintf(stderr, "interrupted; the page holds what was finished: %s/validation.html\n",
                     folder.path().c_str());
    else
        std::printf("%s\npage: %s/validation.html\n",
                    missed == 0 ? "every target is met, or missed for a reason the page states"
                                : (std::to_string(missed) + " targets are missed").c_str(),
                    folder.path().c_str());
    if (!printed())
        return kCannotWrite;
    bool unfinished = false;
    for (const validation::ValidationExperiment& e : all)
        if (!e.failure.empty() && !interrupted) {
            std::fprintf(stderr, "%s: %s\n", e.id.c_str(), e.failure.c_str());
            unfinished = true;
        }
    return interrupted ? kInterrupted : unfinished ? kCannotGoOn : kDone;
}

} // namespace supercircle::cli
