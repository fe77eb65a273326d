#pragma once
// The fits of a diagnosis in the parameters of a replay.

#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/replay/stored_fit.h"

namespace supercircle::diagnosis {

/// All effects and learned laws of the result, most probable first, and last the fit without any.
replay::StoredFits storedFitsOf(const ReplayModel& model, const experiment::Experiment& experiment,
                                const Diagnosis& diagnosis);

} // namespace supercircle::diagnosis
