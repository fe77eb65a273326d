#pragma once
// Scene texts that come through the C interface.

#include "bridge/c/guard.h"
#include "plugin/scene/loader/loader.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::c {

/// `file` in messages; "scene" if null.
std::string fileName(const char* file);
/// Names and values of the JSON object {"name": number}; null: none. Refuses anything else.
std::vector<std::pair<std::string, double>> parametersOf(const char* json);
/// Reads a scene; refuses with all errors, one a line, also those that only Box2D has. `notes`: one a line.
/// `fragmentOf`: as of scene::loadText.
scene::Scene readScene(const std::string& text, const std::string& file,
                       const std::vector<std::pair<std::string, double>>& parameters = {}, std::string* notes = nullptr,
                       std::optional<double> fragmentOf = {});
/// [{"line", "column", "pointer", "what", "expected", "nearest", "note", "text"}]
std::string problemsJson(const std::string& text, const std::string& file);
/// [{"name", "value", "min", "max", "unit", "about"}]; a bound that does not exist is null.
std::string parametersJson(const scene::Scene& scene);

} // namespace supercircle::c
