#pragma once
// From a scene file (docs/scenes.md) to plain data, with everything checked and every problem placed.

#include "plugin/scene/loader/expression.h"
#include "plugin/scene/loader/problem.h"
#include "plugin/scene/loader/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::scene {

/// Loads a scene and puts the overrides in. All problems are appended to `problems` (of syntax errors the first); the
/// result is empty exactly if one of them is an error. Notes (Problem::Severity::Note) may accompany a good scene.
std::optional<Scene> load(const std::string& path, const std::vector<Override>& overrides,
                          std::vector<Problem>& problems);

/// The same from a text; `file` is what messages call it.
std::optional<Scene> loadText(const std::string& text, const std::string& file, const std::vector<Override>& overrides,
                              std::vector<Problem>& problems);

} // namespace supercircle::scene
