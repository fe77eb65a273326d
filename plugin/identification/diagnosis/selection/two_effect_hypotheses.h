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

/// Fits the two pairs of stated numbers that explain most together, each with both numbers outside their intervals.
/// Another specimen differs in several numbers, and one of them alone may explain hardly anything (decision 0248).
/// @param base the fit without effects; only numbers that stand at the end of their interval there are tried
/// @param screened probes beside `base`
/// @param others fitted before: a pair that is among them is not fitted again, and one must beat its single numbers
std::vector<FittedHypothesis> fitTwoNumbers(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& base,
                                            const std::vector<ScreenedProbe>& screened,
                                            const std::vector<FittedHypothesis>& others);

} // namespace supercircle::diagnosis
