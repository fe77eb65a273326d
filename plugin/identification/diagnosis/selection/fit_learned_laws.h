#pragma once
// Fits of the learned laws of learned_laws.h, with their smoothing and description.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

namespace supercircle::diagnosis {

/// Fits at most `most` learned laws, largest predicted gain first. Smoothing is chosen by a Fellner-Schall step.
std::vector<FittedHypothesis> fitLearnedLaws(Evaluator& evaluator, const Likelihood& likelihood,
                                             const FitResult& nominal, std::size_t most);

/// The law with its uncertainty in the range that the runs cover. Elsewhere the posterior standard deviation exceeds
/// half of the prior's, and the law is undefined.
LearnedLaw learnedLawOf(const Model& model, const Likelihood& likelihood, const FittedHypothesis& hypotheses);

} // namespace supercircle::diagnosis
