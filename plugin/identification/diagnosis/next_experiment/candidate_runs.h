#pragma once
// Candidate runs: variations of the first recorded run. None is faster than the recorded runs, because contact and
// release at higher speeds are not validated by any recording (decision 0087).

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/recording/experiment/experiment.h"

#include <vector>

namespace supercircle::diagnosis {

std::vector<CandidateRun> candidateRunsFor(const experiment::Experiment& experiment);

/// The experiment with candidate run `index` as its only run, without readings.
experiment::Experiment withCandidateRun(const experiment::Experiment& experiment, std::size_t index);

} // namespace supercircle::diagnosis
