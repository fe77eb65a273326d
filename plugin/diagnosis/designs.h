#pragma once
// Runs of an experiment that were not made: variations of its first run.

#include "plugin/diagnosis/model.h"
#include "plugin/experiment/experiment.h"

#include <vector>

namespace supercircle::diagnosis {

std::vector<Design> designsFor(const experiment::Experiment& experiment);

/// The experiment with design `index` as its only run, without readings.
experiment::Experiment designed(const experiment::Experiment& experiment, std::size_t index);

} // namespace supercircle::diagnosis
