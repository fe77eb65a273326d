#pragma once
// Free scene in experiment.json (private to experiment/): scene file, recorded pose, release state of each run.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/values.h"

namespace supercircle::experiment {

/// `{"NAME": value, "NAME": {"value": v, "unc": half-width}}` at `key`; empty if absent.
std::vector<SceneParameter> readSceneParameters(Context& context, Object& object, const std::string& key);

/// /scene, /scene_parameters and /observed.
FreeScene readFreeScene(Context& context, Object& top);

/// /strings
std::vector<Bowstring> readStrings(Context& context, Object& top);

/// Reads the scene file beside experiment.file and checks it with the nominal values of every run.
void readSceneFile(Experiment& experiment, std::vector<scene::Problem>& problems);

/// Names of the readings in a CSV file, with their unit.
std::vector<Channel> columnsOf(const Experiment& experiment);

} // namespace supercircle::experiment
