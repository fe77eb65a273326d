#pragma once
// Free scene in experiment.json (private to experiment/): scene file, recorded pose, release state of each run.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/values.h"

namespace supercircle::experiment {

constexpr double kDegrees = 180.0 / 3.14159265358979323846; ///< in a radian

/// `{"NAME": value, "NAME": {"value": v, "unc": half-width}}` at `key`; empty if absent.
std::vector<SceneParameter> readSceneParameters(Context& context, Object& object, const std::string& key);

/// /scene, /scene_parameters and /observed.
FreeScene readFreeScene(Context& context, Object& top);
/// /scene, /scene_parameters and /channels, whose noise goes to `sensors`.
FreeScene readScene(Context& context, Object& top, Sensors& sensors);

/// A unit of a column: how it is written, and units per SI unit.
struct Unit {
    const char* name;
    double perUnit;
};
/// Units in which a quantity may be recorded, the SI unit first.
std::vector<Unit> unitsOf(scene::Observation::Quantity quantity);
/// Completes a channel and its zero, whose observation is known. @return what is wrong, or nothing
std::string setChannel(const std::string& observe, const scene::Observation& observation, Channel& channel,
                       Stated& zero);

/// /strings
std::vector<Bowstring> readStrings(Context& context, Object& top);

/// Reads the scene file beside experiment.file and checks it with the nominal values of every run. @return whether the
/// columns of the runs and their units are known; without them nothing can be said about the files
bool readSceneFile(Experiment& experiment, std::vector<scene::Problem>& problems);

/// Names of the readings in a CSV file, with their unit.
std::vector<Channel> columnsOf(const Experiment& experiment);

} // namespace supercircle::experiment
