#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/subcommands.h"

#include "plugin/identification/replay/parameters.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/lab/sweep/definition.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/scene/loader/document.h"

#include <cmath>
#include <cstdio>

namespace supercircle::cli {

namespace {

std::string range(const scene::Parameter& p) {
    char text[96];
    if (std::isfinite(p.min) && std::isfinite(p.max))
        std::snprintf(text, sizeof text, "%g to %g", p.min, p.max);
    else if (std::isfinite(p.min))
        std::snprintf(text, sizeof text, "from %g", p.min);
    else if (std::isfinite(p.max))
        std::snprintf(text, sizeof text, "up to %g", p.max);
    else
        return "any";
    return text;
}

int checkSweep(const std::string& file, const std::vector<std::string>& parameters) {
    if (!parameters.empty()) {
        std::fprintf(stderr,
                     "--param: a sweep sets its parameters in the file, with \"grid\", \"cases\" and \"fixed\"\n");
        return kBadInput;
    }
    std::vector<scene::Problem> problems;
    const auto loaded = sweep::load(file, problems);
    const auto text = loaded ? scene::readFile(loaded->scene, problems) : Result<std::string>::failure("no sweep");
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    if (!text)
        return kBadInput;
    for (std::size_t set = 0; set < loaded->sets.size(); ++set)
        if (!canStart(*text, loaded->scene, loaded->parameterValues(set)))
            return kBadInput;
    std::printf("%s: valid sweep of %s (%zu sets of parameters, %zu seeds, %zu runs)\n", file.c_str(),
                loaded->scene.c_str(), loaded->sets.size(), loaded->seeds.size(),
                loaded->sets.size() * loaded->seeds.size());
    for (std::size_t set = 0; set < loaded->sets.size() && set < 100; ++set)
        std::printf("  %s\n", sweep::keyOf(loaded->parameterValues(set)).c_str());
    if (loaded->sets.size() > 100)
        std::printf("  and %zu more\n", loaded->sets.size() - 100);
    return printed() ? kDone : kCannotWrite;
}

int checkExperiment(const std::string& file, const std::vector<std::string>& parameters) {
    std::vector<scene::Problem> problems;
    const auto loaded = experiment::load(file, problems);
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
    std::printf("%s: valid experiment (%s, %zu specimens, %zu runs, %zu markers)\n", file.c_str(),
                experiment::name(loaded->protocol), loaded->specimens.size(), loaded->runs.size(),
                loaded->markers.size());
    for (const experiment::Run& run : loaded->runs)
        std::printf("  %-16s %zu samples, %g s%s\n", run.file.c_str(), run.readings.time.size(),
                    run.driveTime.back() - run.driveTime.front(), run.markers.time.empty() ? "" : ", with markers");
    for (const replay::ParameterInfo& p : replay::parameterList(*loaded))
        std::printf("  %-20s %-12.6g +- %-10.3g %-6s %s\n", p.name.c_str(),
                    replay::get(values, *loaded, p.name).value_or(0.0), p.stated.halfWidth, p.unit.c_str(),
                    p.about.c_str());
    return printed() ? kDone : kCannotWrite;
}

} // namespace

int check(const std::string& file, const std::vector<std::string>& parameters) {
    const std::string schema = schemaOf(file);
    if (schema.rfind("rod-recordings/", 0) == 0)
        return checkExperiment(file, parameters);
    if (schema.rfind("supercircle-sweep/", 0) == 0)
        return checkSweep(file, parameters);
    const auto input = loadScene(file, parameters);
    if (!input)
        return kBadInput;
    // Only a session can tell whether the start is free of overlaps: it is interrupted before the first step.
    const std::atomic<bool> interrupt{true};
    lab::RunOptions options;
    options.interrupt = &interrupt;
    options.keepFrames = false;
    const scene::Scene& scene = input->scene;
    if (const lab::RunResult out = lab::runScene(scene, input->host, options); out.status == lab::RunStatus::BadScene) {
        std::fprintf(stderr, "%s: %s\n", file.c_str(), out.message.c_str());
        return kBadInput;
    }
    const auto count = [](std::size_t n, const char* what) {
        return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
    };
    const std::string dropped = scene.drop ? " and " + std::to_string(scene.drop->count) + " dropped" : "";
    std::printf(
        "%s: valid scene (%s%s, %s, %s)\n", file.c_str(), count(scene.shells.size(), "shell").c_str(), dropped.c_str(),
        scene.rigid.bodies.size() == 1 ? "1 body" : (std::to_string(scene.rigid.bodies.size()) + " bodies").c_str(),
        count(scene.parameters.size(), "parameter").c_str());
    for (const scene::Parameter& p : scene.parameters)
        std::printf("  %-16s %-10.6g %-18s %-4s %s\n", p.name.c_str(), p.value, range(p).c_str(), p.unit.c_str(),
                    p.about.c_str());
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
