#include "plugin/identification/replay/scene_of_run.h"

#include "plugin/scene/loader/loader.h"

namespace supercircle::replay {

std::optional<scene::Scene> sceneOf(const experiment::Experiment& e, std::size_t run, const Parameters& p,
                                    std::string& why) {
    std::vector<scene::Override> overrides;
    for (const SceneValue& v : p.scene)
        if (holdsIn(v, e, run))
            overrides.push_back({v.name, v.value});
    std::vector<scene::Problem> problems;
    auto scene = scene::loadText(e.scene->text, e.scene->file, overrides, problems);
    for (const scene::Problem& problem : problems)
        if (why.empty() && problem.severity == scene::Problem::Severity::Error)
            why = problem.toString();
    return scene ? std::optional(*std::move(scene)) : std::nullopt;
}

} // namespace supercircle::replay
