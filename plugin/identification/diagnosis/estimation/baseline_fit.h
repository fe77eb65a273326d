#pragma once
// Baseline fit: the nominal parameters alone, inside their stated bounds. Its residual is what the diagnosis explains.
//
// A search stays on its solution branch: a strip that buckles to the other side does so along the whole search. Where
// the misfit is large, the fit restarts from the best coarse simulations of points across the bounds. It also restarts
// where the misfit is marginal, and wherever it is held at the edge of a branch (decision 0076).

#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/fit.h"

#include <functional>
#include <memory>
#include <string>

namespace supercircle::diagnosis {

struct BaselineFit {
    std::string failure;                    ///< why there is none; also empty if the evaluator was stopped
    std::unique_ptr<Likelihood> likelihood; ///< with the model error evaluated near the fit
    FitResult fit;                          ///< with derivatives at the fit
};

using StageReporter = std::function<void(double, const std::string&)>;

/// @param stage receives the progress of the diagnosis, 0.02 to 0.2
BaselineFit fitBaseline(const RecordedData& data, Evaluator& evaluator, const Noise& noise,
                        const DiagnosisSettings& settings, const StageReporter& stage);

/// Restarts an existing fit from the opposite side and across the bounds. True if a lower minimum was found.
[[nodiscard]] bool searchLowerMinimum(Evaluator& evaluator, const DiagnosisSettings& settings,
                                      const Likelihood& likelihood, FitResult& found);

/// The same from one given start.
[[nodiscard]] bool refitFrom(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start,
                             FitResult& found);

} // namespace supercircle::diagnosis
