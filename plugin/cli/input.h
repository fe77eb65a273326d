#pragma once
// Reading a scene or an experiment for a verb: overrides from NAME=VALUE, problems printed where a user looks.

#include "plugin/lab/sweep/definition.h"
#include "plugin/recording/experiment/experiment.h"
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

/// Reads NAME=VALUE texts; false after a message.
bool readOverrides(const std::vector<std::string>& parameters, std::vector<scene::Override>& overrides);

/// Loads, checks and builds the rigid world; prints every problem to stderr (notes too unless `quiet`). Empty: exit 2.
std::optional<Input> loadScene(const std::string& file, const std::vector<std::string>& parameters, bool quiet = false);

/// What a file calls itself: the text of its "schema", empty if there is none. Says nothing about problems.
std::string schemaOf(const std::string& file);

/// Loads an experiment; prints every problem to stderr (notes too unless `quiet`). Empty: exit 2.
std::optional<experiment::Experiment> loadExperiment(const std::string& file, bool quiet);

/// Loads a sweep; prints every problem to stderr. Empty: exit 2.
std::optional<sweep::Definition> loadSweep(const std::string& file);

/// A scene with these values of its parameters; empty after problems.
std::optional<scene::Scene> loadWith(const std::string& sceneText, const std::string& sceneFile,
                                     const std::vector<sweep::Setting>& settings,
                                     std::vector<scene::Problem>& problems);
/// Loads the scene with these values and builds its world, without playing. Prints every problem.
bool canStart(const std::string& sceneText, const std::string& sceneFile, const std::vector<sweep::Setting>& settings);

/// Folder for an experiment's results: `out`, or if that is empty out/<name of the experiment's folder>_<verb>.
std::string resultsFolder(const std::string& file, const std::string& out, const std::string& verb);

} // namespace supercircle::cli
