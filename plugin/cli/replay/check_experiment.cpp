#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"

#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"

#include <atomic>
#include <cstdio>

namespace supercircle::cli {

namespace {

/// Plays the first steps of each run. @return why one cannot be simulated, or nothing
std::string firstSteps(const experiment::Experiment& e, const replay::Parameters& values) {
    constexpr int kSteps = 20;
    const std::vector<std::string> names = experiment::runNames(e, true);
    for (std::size_t run = 0; run < e.runs.size(); ++run) {
        std::atomic<bool> enough{false};
        int steps = 0;
        const replay::Simulated played = replay::simulate(e, run, values, replay::Resolution::coarse(),
                                                          {&enough, [&](double) { enough = ++steps >= kSteps; }});
        if (!played.failure.empty())
            return names[run] + " cannot be simulated: " + played.failure;
    }
    return {};
}

} // namespace

int checkExperiment(const std::string& file, const std::vector<std::string>& parameters) {
    std::vector<scene::Problem> problems;
    const auto loaded =
        experiment::load(file, problems, allowOutside ? experiment::Outside::Allowed : experiment::Outside::Refused);
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (!loaded)
        return kBadInput;
    replay::Parameters values = replay::nominal(*loaded);
    std::vector<scene::Override> overrides;
    if (!readOverrides(parameters, overrides))
        return kBadInput;
    for (const scene::Override& o : overrides)
        if (const std::string why = replay::set(values, *loaded, o.name, o.value); !why.empty()) {
            std::fprintf(stderr, "--param %s=%.10g: %s\n", o.name.c_str(), o.value, why.c_str());
            return kBadInput;
        }
    if (const std::string why = firstSteps(*loaded, values); !why.empty()) {
        std::fprintf(stderr, "%s: it is valid, but %s\n", file.c_str(), why.c_str());
        return kBadInput;
    }
    std::printf("%s: valid experiment (%s, %zu specimens, %zu runs, %zu markers)\n", file.c_str(),
                experiment::name(loaded->protocol),
                loaded->scene ? loaded->scene->specimens.size() : loaded->specimens.size(), loaded->runs.size(),
                loaded->markers.size());
    const bool free = experiment::isFree(*loaded);
    std::printf("  simulated as %s\n",
                experiment::isMechanism(*loaded)
                    ? (free ? "bodies on joints that move freely" : "bodies on joints, one moved by the machine")
                    : (free ? "rods that move freely" : "rods that are moved slowly, their vibration damped"));
    if (!experiment::furtherChannels(*loaded).empty()) {
        const auto tell = [](const experiment::Channel& c, double noise) {
            std::printf("  compared: %s, column %s, noise of about %.3g %s, weight %g\n", c.name.c_str(),
                        c.column.c_str(), c.perUnit * noise, c.unit.c_str(), c.weight);
        };
        tell(experiment::channel(*loaded), loaded->sensors.forceNoise);
        for (const experiment::FurtherChannel& c : experiment::furtherChannels(*loaded))
            tell(c.channel, c.noise);
    }
    for (const experiment::Run& run : loaded->runs)
        std::printf(
            "  %-16s %zu samples, %g s%s%s\n", run.file.c_str(), run.readings.time.size(),
            run.driveTime.back() - run.driveTime.front(), run.markers.time.empty() ? "" : ", with markers",
            run.specimen < 0
                ? ""
                : (", specimen " + loaded->scene->specimens[static_cast<std::size_t>(run.specimen)].id).c_str());
    for (const replay::ParameterInfo& p : replay::parameterList(*loaded))
        std::printf("  %-20s %-12.6g +- %-10.3g %-6s %s\n", p.name.c_str(),
                    replay::get(values, *loaded, p.name).value_or(0.0), p.stated.halfWidth, p.unit.c_str(),
                    p.about.c_str());
    if (loaded->scene)
        for (const experiment::BatchParameter& b : loaded->scene->batch)
            if (b.scale > 0.0)
                std::printf("  batch: %s differs between specimens, by a standard deviation of the order of %g\n",
                            b.name.c_str(), b.scale);
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
