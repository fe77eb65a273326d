#pragma once
// Profile-likelihood intervals of fitted parameters. Two parameters of a law often compensate each other along a bent
// valley, so linearised intervals are too short. One parameter is held, all others are fitted again, until chi-squared
// has risen by the 90 % level. A profile that finds a better fit stops there.
//
// Simulations make chi-squared noisy. Where a profile exceeds its convex hull, the level is raised by twice the noise
// amplitude, and the outermost point below it ends the interval (decision 0084).
//
// Source: D. J. Venzon, S. H. Moolgavkar, "A method for computing profile-likelihood-based confidence intervals", Appl.
// Statist. 37 (1988) 87.

#include "plugin/identification/diagnosis/estimation/sandwich.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/result.h"

#include <optional>
#include <vector>

namespace supercircle::diagnosis {

/// 90 % intervals of the parameters after the nominal ones, in x, by the linearised posterior.
/// @param jacobian d(whitened simulation)/dx at the fit
/// @param dispersions of each of x (sandwich.h)
std::vector<Interval> linearIntervals(const Variables& variables, const FitResult& fitted,
                                      const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& dispersions);

struct Profiled {
    std::vector<Interval> intervals; ///< in x; incomplete where there is a better fit
    std::optional<FitResult> better; ///< with one parameter held: it can be improved
};

/// The same by profiles that start from the linearised posterior. Where a simulation fails or the diagnosis is stopped,
/// the linearised end stays.
/// @param stopAtBetter whether a fit better by more than one dispersion ends it
Profiled profileIntervals(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                          const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& dispersions,
                          bool stopAtBetter = false);

/// 90 % interval of a derived quantity. It is linearised in coordinates (product, extent), because the factors alone
/// are correlated along the valley.
/// @param first index of the first variable of its candidate
Interval derivedInterval(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                         const Eigen::MatrixXd& jacobian, const DerivedQuantity& product, Eigen::Index first);

/// Value of a derived quantity at x.
double derivedValue(const DerivedQuantity& product, const Variables& variables, const Eigen::VectorXd& x,
                    Eigen::Index first);

/// Intervals of a fit's parameters after the nominal ones.
struct ParameterIntervals {
    std::vector<Interval> intervals;            ///< in x
    std::vector<std::vector<Interval>> derived; ///< of each term; empty: not computed
};

} // namespace supercircle::diagnosis
