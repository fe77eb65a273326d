#pragma once
// Several specimens in one experiment with a scene (private to experiment/): /specimens, /batch, /runs/N/specimen.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/values.h"

namespace supercircle::experiment {

/// /specimens and /batch. `scene.parameters` are read before.
void readSpecimensOf(FreeScene& scene, Context& context, Object& top);

/// Index of the specimen that a run names; -1 if the experiment has none.
int readSpecimenOfRun(Object& object, const Run& run, const FreeScene& scene);

/// Notes specimens that no run has.
void noteUnusedSpecimens(const Experiment& experiment, Object& top);

} // namespace supercircle::experiment
