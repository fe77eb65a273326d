#pragma once
// Recordings of a machine, or of weights, whose set-up is a scene (private to import/).

#include "plugin/recording/import/import.h"
#include "plugin/recording/import/template.h"
#include "plugin/scene/loader/scene.h"

#include <string>

namespace supercircle::importing {

/// A scene as read from a file.
struct NamedScene {
    std::string name; ///< of the file, without folders
    std::string path; ///< where it was read
    std::string text;
    scene::Scene scene;
};

/// Reads a scene file; `file` may be the name of a scene that comes with the program.
Result<NamedScene> readNamedScene(const std::string& file);

/// experiment.json of runs with force and displacement, whose set-up is the scene of the options. A scene with a
/// machine is driven by the displacement, and its force is compared. A scene with loads is driven by the force, and a
/// displacement is compared.
/// @param runs entries of /runs as other protocols have them, as JSON
Result<Description> describeScene(const Imported& imported, const TemplateOptions& options, const std::string& runs);

} // namespace supercircle::importing
