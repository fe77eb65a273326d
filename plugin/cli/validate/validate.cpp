#include "bridge/box2d/lab_world.h"
#include "plugin/cli/data.h"
#include "plugin/cli/output.h"
#include "plugin/cli/verbs.h"
#include "plugin/lab/validation/validation.h"

#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

namespace {

int explainFilter(const std::string& filter) {
    std::fprintf(stderr, "no experiment is called \"%s\"; there are:\n", filter.c_str());
    for (const validation::Definition& d : validation::experiments())
        std::fprintf(stderr, "  %-4s %s\n", d.id.c_str(), d.title.c_str());
    return kBadInput;
}

} // namespace

int validate(const ValidateArguments& a) {
    if (std::error_code none; !std::filesystem::is_directory(a.data, none)) {
        std::fprintf(stderr, "there is no folder %s with reference curves; name one with --data\n", a.data.c_str());
        return kBadInput;
    }
    Folder folder(a.out);
    if (const std::string error = folder.prepare(); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    validation::Settings settings;
    settings.host = [](const step::RigidWorldDefinition& definition, std::string& error) {
        return std::shared_ptr<step::HostWorld>(bridge::makeWorld(definition, error));
    };
    settings.scenes = scenesFolder();
    settings.data = a.data;
    settings.quick = a.quick;
    settings.filter = a.filter;
    settings.jobs = a.jobs;
    settings.interrupt = &interrupted;
    settings.progress = [](const std::string& line) {
        std::printf("%s\n", line.c_str());
        std::fflush(stdout);
    };
    const std::vector<validation::Experiment> all = validation::runAll(settings);
    if (all.empty())
        return explainFilter(a.filter);
    const auto files = validation::files(all, settings);
    const std::string error = files ? record::writeAtomically(folder.path(), files.value) : files.error;
    if (!error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    const int missed = validation::surprises(all);
    std::printf("%s\npage: %s/validation.html\n",
                missed == 0 ? "every target is met, or missed for a reason the page states"
                            : (std::to_string(missed) + " targets are missed").c_str(),
                folder.path().c_str());
    if (!printed())
        return kCannotWrite;
    bool unfinished = false;
    for (const validation::Experiment& e : all)
        if (!e.failure.empty() && !interrupted) {
            std::fprintf(stderr, "%s: %s\n", e.id.c_str(), e.failure.c_str());
            unfinished = true;
        }
    return interrupted ? kInterrupted : unfinished ? kCannotGoOn : kDone;
}

} // namespace supercircle::cli
