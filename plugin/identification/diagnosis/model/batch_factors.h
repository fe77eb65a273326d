#pragma once
// Parameters that differ between the specimens of a scene (private to the diagnosis): which deviations the readings can
// tell apart, and their scalars.

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/recording/experiment/experiment.h"

namespace supercircle::diagnosis {

/// The factors whose deviations are free: of those that change all readings alike only the first, with the names of the
/// others. Simulates one run of each specimen once a factor; after an interruption the result is unusable.
std::vector<BatchFactor> batchFactorsOf(const experiment::Experiment& experiment, const std::atomic<bool>* interrupt);

/// A deviation for each specimen that has a run.
std::vector<Scalar> deviationsOf(const experiment::Experiment& experiment, const BatchFactor& factor, int index);

} // namespace supercircle::diagnosis
