#pragma once
// Competing hypotheses for the choice of the next experiment: the fitted effects by probability. Near the detection
// limit, effects that explain nearly as much in the screening are fitted and added (decision 0086).

#include "plugin/identification/diagnosis/next_experiment.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// An effect of the result.
struct ReportedEffect {
    std::string label;
    double probability = 0.0;
    const FittedHypothesis* hypothesis = nullptr; ///< the fitted hypothesis that represents it
    bool confounded = false;                      ///< confounded with the first one
};

/// At most four effects, most probable first, then the mirror image of the first if its sign is ambiguous, and the
/// baseline if it is plausible.
/// @param reported most probable first
/// @param adequate probability of the baseline
std::vector<CompetingHypothesis> competingHypotheses(Evaluator& evaluator, const Likelihood& likelihood,
                                                     const FitResult& base, const std::vector<ReportedEffect>& reported,
                                                     const std::vector<ScreenedProbe>& screened, double adequate);

} // namespace supercircle::diagnosis
