#pragma once
// Intervals of the parameters of a hypothesis, by cost: linear, linear with careful derivatives, profile likelihood.

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/estimation/profile.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

#include <vector>

namespace supercircle::diagnosis {

/// By the derivatives at the fit, with dispersions that residuals of unequal size ask for.
std::vector<Interval> linearIntervals(const Likelihood& likelihood, const Model& model, const FitResult& fitted,
                                      const Eigen::MatrixXd& jacobian);

/// What careful intervals are computed with.
struct IntervalSearch {
    Evaluator& evaluator;
    const Likelihood& likelihood;
    const Grouping& grouping;
    const DiagnosisSettings& settings;
    const std::vector<ScreenedProbe>& screened;
    const PredictiveScore& baselineScore;
    double baselineChiSquared;
};

/// By careful derivatives, or by profiles, which may find a better fit: it replaces that of the hypothesis.
ParameterIntervals carefulIntervals(const IntervalSearch& search, bool profiles, FittedHypothesis& hypothesis);

} // namespace supercircle::diagnosis
