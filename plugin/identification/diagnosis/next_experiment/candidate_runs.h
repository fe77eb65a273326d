#pragma once
// Candidate runs: variations of recorded runs. None is driven faster than the recorded runs, because contact and
// release at higher speeds are not validated by any recording (decision 0087). What a scene lets a run say of itself,
// such as its release or its load, is varied too (decision 0249).

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/experiment.h"

#include <vector>

namespace supercircle::diagnosis {

std::vector<CandidateRun> candidateRunsFor(const experiment::Experiment& experiment);

/// The experiment with candidate run `index` as its only run, without readings.
/// @param parameters those of the recorded runs; on return those of the candidate run
experiment::Experiment withCandidateRun(const experiment::Experiment& experiment, std::size_t index,
                                        replay::Parameters& parameters);

} // namespace supercircle::diagnosis
