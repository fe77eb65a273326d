#pragma once
// Reading a scene for a subcommand; problems go to stderr.

#include "plugin/scene/loader/loader.h"
#include "supercircle/step/port.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// A scene that can be started.
struct Input {
    scene::Scene scene;
    std::shared_ptr<step::HostWorld> host; ///< built from scene.rigid
};

/// Reads NAME=VALUE texts of `option`; false after a message.
[[nodiscard]] bool readOverrides(const std::vector<std::string>& parameters, std::vector<scene::Override>& overrides,
                                 const char* option = "--param");

/// Loads, checks and builds the rigid world; prints every problem to stderr (notes too unless `quiet`). Empty: exit 2.
/// @param mechanisms whether scenes that Box2D cannot play are taken (scene::isMechanism), without a world
[[nodiscard]] std::optional<Input> loadScene(const std::string& file, const std::vector<std::string>& parameters,
                                             bool quiet = false, bool mechanisms = false);

/// The text of a file's "schema"; empty if there is none. Prints no problems.
std::string schemaOf(const std::string& file);

} // namespace supercircle::cli
