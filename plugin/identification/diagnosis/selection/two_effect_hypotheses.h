#pragma once
// Hypotheses of two effects. The second one is screened with the first one in place, because a strong effect hides and
// displaces a weak one (decision 0082).

#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

namespace supercircle::diagnosis {

/// Fits the best single effect with the two that explain most of its residual, and the second best with one.
/// @param singles best first
/// @param share of the probe amplitudes at which effects are simulated (screen())
std::vector<FittedHypothesis> fitTwoEffects(Evaluator& evaluator, const Likelihood& likelihood,
                                            const std::vector<FittedHypothesis>& singles, double share = 1.0);

} // namespace supercircle::diagnosis
