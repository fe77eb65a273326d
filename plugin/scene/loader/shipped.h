#pragma once
// Scenes that come with the program.

#include <string>

namespace supercircle::scene {

/// Folder of a kind of data files (`name`: "scenes", ...): of the installation this program belongs to, else `built`.
std::string dataFolder(const char* name, const char* built);
/// Folder of the project's scenes.
std::string shippedFolder();
/// File of a shipped scene by its name, in that folder or its `experiments`; empty: none has it.
std::string shippedScene(const std::string& name);
/// Names of the scenes for experiments.
std::string shippedNames();

} // namespace supercircle::scene
