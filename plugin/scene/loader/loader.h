#pragma once
// Loads a scene file (docs/reference/scene_format.md) into plain data; every problem is reported with its position.

#include "plugin/scene/loader/expression.h"
#include "plugin/scene/loader/problem.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/support/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::scene {

/// Loads a scene with the given parameter values. All problems are appended to `problems` (of syntax errors the first);
/// the call fails, with the text of the errors, exactly if one of them is an error. Notes (Problem::Severity::Note) may
/// accompany a valid scene.
Result<Scene> load(const std::string& path, const std::vector<Override>& overrides, std::vector<Problem>& problems);

/// The same from a text; `file` is its name in messages. `fragmentOf`: the text is added to a world of that many
/// host units per metre, which hold where it has no lengthScale; it needs neither protocol nor duration.
Result<Scene> loadText(const std::string& text, const std::string& file, const std::vector<Override>& overrides,
                       std::vector<Problem>& problems, std::optional<double> fragmentOf = {});

} // namespace supercircle::scene
