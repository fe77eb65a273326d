#pragma once
// Reading a scene for a verb: overrides from NAME=VALUE, problems printed where a user looks.

#include "plugin/scene/loader.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// Loads and checks; prints every problem to stderr. Empty: exit 2.
std::optional<scene::Scene> loadScene(const std::string& file, const std::vector<std::string>& parameters);

} // namespace supercircle::cli
