#pragma once
// Search for hypotheses: promising effects, other variants of their laws, pairs, and learned laws. Each step is taken
// only if the one before leaves a residual (docs/theory/diagnosis.md).

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Input of the search; everything outlives it.
struct SearchInput {
    const RecordedData& data;
    Evaluator& evaluator;
    const DiagnosisSettings& settings;
    const Likelihood& likelihood;
    const Grouping& grouping;
    const FitResult& base; ///< baseline fit
    const PredictiveScore& baselineScore;
    const std::vector<ScreenedProbe>& screened;
    double p = 1.0;               ///< family-wise, of the baseline
    double excessKurtosis = 0.0;  ///< of the noise
    double noiseChiSquared = 1.0; ///< upper bound of the noise per row (noiseChiSquaredBound())
};

/// Predictive score of a fit, as the settings demand.
PredictiveScore predictiveScoreOf(Evaluator& evaluator, const Likelihood& likelihood, const Grouping& grouping,
                                  const FitResult& fitted, const DiagnosisSettings& settings);

/// Localisation of the residual of a fit.
Localisation localiseResidual(const Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                              const DiagnosisSettings& settings);

struct SearchResult {
    std::vector<std::string> notTried; ///< what the time limit has left out, in words
    std::vector<FittedHypothesis>
        hypotheses; ///< singles best first, then pairs, then learned laws; `mustBeat` has indices into it
    Localisation residualAfterBest; ///< residual of the first; meaningless without any
    /// Nominal parameters better than the baseline, found by fits of effects that change no reading.
    std::optional<ParameterPoint> elsewhere{};
    double least = 0.0; ///< chi-squared there
};

/// Stops early with partial results when the evaluator is stopped.
/// @param stage receives the step and the progress of the whole diagnosis
SearchResult search(const SearchInput& input, const std::function<void(double, const std::string&)>& stage);

} // namespace supercircle::diagnosis
