#include "plugin/cli/sweep/sweep_input.h"

#include "bridge/box2d/lab_world.h"

#include <cstdio>

namespace supercircle::cli {

std::optional<sweep::SweepDefinition> loadSweep(const std::string& file) {
    std::vector<scene::Problem> problems;
    auto loaded = sweep::load(file, problems);
    for (const scene::Problem& p : problems)
        std::fprintf(stderr, "%s\n", p.toString().c_str());
    return loaded;
}

Result<scene::Scene> loadWithParameters(const std::string& text, const std::string& file,
                                        const std::vector<sweep::ParameterValue>& values,
                                        std::vector<scene::Problem>& problems) {
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : values)
        overrides.push_back({name, value});
    return scene::loadText(text, file, overrides, problems);
}

bool canStart(const std::string& sceneText, const std::string& sceneFile,
              const std::vector<sweep::ParameterValue>& values) {
    std::vector<scene::Problem> problems;
    const auto scene = loadWithParameters(sceneText, sceneFile, values, problems);
    for (const scene::Problem& p : problems)
        if (p.severity == scene::Problem::Severity::Error)
            std::fprintf(stderr, "%s\n", p.toString().c_str());
    std::string why;
    if (scene && bridge::makeWorld(scene->rigid, why))
        return true;
    if (scene)
        std::fprintf(stderr, "%s: %s\n", sceneFile.c_str(), why.c_str());
    std::fprintf(stderr, "%s: cannot start with the parameters %s\n", sceneFile.c_str(), sweep::keyOf(values).c_str());
    return false;
}

} // namespace supercircle::cli
