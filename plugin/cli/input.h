#pragma once
// Reading a scene, a sweep or an experiment for a subcommand; problems go to stderr.

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

/// Reads NAME=VALUE texts of `option`; false after a message.
[[nodiscard]] bool readOverrides(const std::vector<std::string>& parameters, std::vector<scene::Override>& overrides,
                                 const char* option = "--param");

/// Loads, checks and builds the rigid world; prints every problem to stderr (notes too unless `quiet`). Empty: exit 2.
[[nodiscard]] std::optional<Input> loadScene(const std::string& file, const std::vector<std::string>& parameters,
                                             bool quiet = false);

/// The text of a file's "schema"; empty if there is none. Prints no problems.
std::string schemaOf(const std::string& file);

/// Loads an experiment; prints every problem to stderr (notes too unless `quiet`). Empty: exit 2.
[[nodiscard]] std::optional<experiment::Experiment> loadExperiment(const std::string& file, bool quiet);

/// Loads a sweep; prints every problem to stderr. Empty: exit 2.
[[nodiscard]] std::optional<sweep::SweepDefinition> loadSweep(const std::string& file);

/// A scene with these parameter values; empty after problems.
Result<scene::Scene> loadWithParameters(const std::string& sceneText, const std::string& sceneFile,
                                        const std::vector<sweep::ParameterValue>& values,
                                        std::vector<scene::Problem>& problems);
/// Loads the scene with these values and builds its world, without a step. Prints every problem.
[[nodiscard]] bool canStart(const std::string& sceneText, const std::string& sceneFile,
                            const std::vector<sweep::ParameterValue>& values);

/// Folder for an experiment's results: `out`, or if that is empty out/<name of the experiment's folder>_<suffix>.
std::string resultsFolder(const std::string& file, const std::string& out, const std::string& suffix);

} // namespace supercircle::cli
