#pragma once
// Laws of the user among the candidates of a diagnosis.

#include "plugin/identification/diagnosis/model/candidate_effects.h"
#include "plugin/identification/diagnosis/own_law.h"

namespace supercircle::diagnosis {

/// @param largestBend curvature change of a simulated run, 1/m; 0: unknown
OwnLawRange ownLawRange(const ExperimentScales& scales, double largestBend);

/// Appends the law to the candidates of a diagnosis. Empty, or why it cannot be fitted: one of its
/// parameters must be a factor of what it changes.
[[nodiscard]] std::string addOwnLaw(CandidateEffects& candidateEffects, const experiment::Experiment& experiment,
                                    const StartedLaw& started, const OwnLawRange& range);

} // namespace supercircle::diagnosis
