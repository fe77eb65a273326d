#pragma once
// What a free scene adds to experiment.json (private to experiment/): the scene file, whose pose is recorded, how each
// run was let go.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/values.h"

namespace supercircle::experiment {

/// `{"NAME": value, "NAME": {"value": v, "unc": half-width}}` at `key`; empty if absent.
std::vector<SceneParameter> readSceneParameters(Context& context, Object& object, const std::string& key);

/// /scene, /scene_parameters and /observed.
FreeScene readFreeScene(Context& context, Object& top);

/// /strings
std::vector<String> readStrings(Context& context, Object& top);

/// Reads the scene file beside experiment.file and tries it with the nominal values of every run.
void readSceneFile(Experiment& experiment, std::vector<scene::Problem>& problems);

/// Names the readings of this column may have in a CSV file, and what one of ours is in its unit.
std::vector<Channel> columnsOf(const Experiment& experiment);

} // namespace supercircle::experiment
