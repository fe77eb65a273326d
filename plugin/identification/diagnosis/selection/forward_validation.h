#pragma once
// Free runs are held out forward in time (decision 0193): each hypothesis is fitted to the first third, half and two
// thirds of all runs, and each fit forecasts the rows up to the next of these shares. By the chain rule of probability
// the sum of the three scores is the log density of all that follows the first third.
//
// Source: A. P. Dawid, "Statistical theory: the prequential approach", J. R. Stat. Soc. A 147 (1984) 278.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/cross_validation.h"

#include <cstdint>
#include <vector>

namespace supercircle::diagnosis {

/// Folds are the intervals of time after the shares, blocks their half oscillations. The beginning has none.
Grouping forwardGroupingOf(const Likelihood& likelihood);

/// Scores of forecasts. Nothing stands in for a forecast; where its error and that of the fit to all rows differ by
/// more than a linear forecast explains, the fold counts in PredictiveScore::nonlinear.
PredictiveScore forwardValidate(Evaluator& evaluator, const Likelihood& likelihood, const Grouping& grouping,
                                const FitResult& fitted);

/// Whether the forecasts of each run hold: standardised squared error a row e' (1 + J C J')^-1 e, with its 95 % lower
/// bound by the Bayesian bootstrap over blocks.
std::vector<RunForecast> forecastsOf(const Likelihood& likelihood, const Grouping& grouping,
                                     const PredictiveScore& score, std::uint64_t seed);

} // namespace supercircle::diagnosis
