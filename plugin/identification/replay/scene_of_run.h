#pragma once
// The scene of a run with the values of its parameters (private to replay/).

#include "plugin/identification/replay/parameters.h"
#include "plugin/scene/loader/scene.h"

namespace supercircle::replay {

/// The scene of a run; empty, with the reason in `why`, for invalid values.
std::optional<scene::Scene> sceneOf(const experiment::Experiment& e, std::size_t run, const Parameters& p,
                                    std::string& why);

} // namespace supercircle::replay
