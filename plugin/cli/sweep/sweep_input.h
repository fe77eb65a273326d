#pragma once
// Reading a sweep and the scene that it varies; problems go to stderr.

#include "plugin/lab/sweep/definition.h"
#include "plugin/scene/loader/loader.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// Loads a sweep; prints every problem to stderr. Empty: exit 2.
[[nodiscard]] std::optional<sweep::SweepDefinition> loadSweep(const std::string& file);

/// A scene with these parameter values; empty after problems.
Result<scene::Scene> loadWithParameters(const std::string& sceneText, const std::string& sceneFile,
                                        const std::vector<sweep::ParameterValue>& values,
                                        std::vector<scene::Problem>& problems);
/// Loads the scene with these values and builds its world, without a step. Prints every problem.
[[nodiscard]] bool canStart(const std::string& sceneText, const std::string& sceneFile,
                            const std::vector<sweep::ParameterValue>& values);

} // namespace supercircle::cli
