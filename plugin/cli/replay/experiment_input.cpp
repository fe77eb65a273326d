#include "plugin/cli/replay/experiment_input.h"

#include "plugin/cli/subcommands.h"
#include "plugin/recording/experiment/load.h"

#include <cstdio>
#include <filesystem>

namespace supercircle::cli {

std::optional<experiment::Experiment> loadExperiment(const std::string& file, bool quiet, const std::string& channel) {
    std::vector<scene::Problem> problems;
    auto loaded =
        experiment::load(file, problems, allowOutside ? experiment::Outside::Allowed : experiment::Outside::Refused);
    for (const scene::Problem& p : problems)
        if (p.severity == scene::Problem::Severity::Error || !quiet)
            std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (!loaded)
        return std::nullopt;
    if (channel.empty())
        return *std::move(loaded);
    auto out = experiment::withFirstChannel(*std::move(loaded), channel);
    if (!out)
        std::fprintf(stderr, "--channel: %s\n", out.error().c_str());
    return out ? std::optional(*std::move(out)) : std::nullopt;
}

std::string resultsFolder(const std::string& file, const std::string& out, const std::string& suffix) {
    if (!out.empty())
        return out;
    const std::string name = std::filesystem::absolute(file).parent_path().filename().string();
    return "out/" + (name.empty() ? "experiment" : name) + "_" + suffix;
}

} // namespace supercircle::cli
