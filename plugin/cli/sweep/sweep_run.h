#pragma once
// One run of a sweep, executed in its own process.

#include "plugin/lab/sweep/definition.h"
#include "plugin/scene/loader/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// Runs the scene and serialises the record (sweep::serialise). Throws sweep::TaskInterrupted when interrupted,
/// std::runtime_error when the scene cannot be started.
std::string runOne(const std::string& sceneText, const std::string& sceneFile,
                   const std::vector<sweep::ParameterValue>& values, std::int64_t seed,
                   std::optional<scene::Accuracy> accuracy = {});

} // namespace supercircle::cli
