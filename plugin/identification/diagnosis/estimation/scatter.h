#pragma once
// Standard deviation between specimens by marginal likelihood: deviations and parameters integrated out by Laplace's
// method about a fit (L. Tierney, J. B. Kadane, J. Am. Stat. Assoc. 81 (1986) 82), prior half-normal (A. Gelman,
// Bayesian Anal. 1 (2006) 515).

#include "plugin/identification/diagnosis/fit.h"

#include <vector>

namespace supercircle::diagnosis {

/// Posterior of a standard deviation tau, in units of the scale of its prior.
struct Scatter {
    double median = 0.0, low = 0.0, high = 0.0; ///< and its 5 % and 95 % quantiles
    double evidence = 0.0;                      ///< log Bayes factor over tau = 0
    std::size_t specimens = 0;
    bool isPrior = false; ///< fewer than three specimens: the prior alone
};

/// One for each factor of Model::batch().
std::vector<Scatter> scattersOf(const Model& model, const Likelihood& likelihood, const FitResult& fitted);

/// Fits again with the scatter that the fit before shows, until it stays. Without a batch nothing is done.
/// @return false if a fit failed; `fitted` is then as before
bool settleScatter(Evaluator& evaluator, const Likelihood& likelihood, FitResult& fitted);

} // namespace supercircle::diagnosis
