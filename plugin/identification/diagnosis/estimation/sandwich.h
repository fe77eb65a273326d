#pragma once
// Sandwich estimate of the dispersion by which an interval is wider than the curvature of chi-squared says.
//
// In a correct model the information and the scatter of the score over independent blocks agree. With a second unnamed
// effect, another simulator's error or longer noise correlation the scatter is larger. It is taken over strokes of
// runs, force and markers apart, corrected for leverage, and mixed with the model-based variance where few strokes
// contribute. Student's quantile with Satterthwaite's degrees of freedom replaces the normal one (decision 0084).
//
// Sources: H. White, Econometrica 50 (1982) 1; R. M. Bell, D. F. McCaffrey, Survey Methodology 28 (2002) 169 (leverage
// correction).

#include "plugin/identification/diagnosis/fit.h"

#include <Eigen/Core>

namespace supercircle::diagnosis {

constexpr double k90 = 1.6448536269514722; ///< quantile of a normal distribution: 90 % lie within it

/// Ratio of the variance of each of x to the model-based one, such that a normal 90 % quantile holds. At least 1 and
/// the mean squared residual.
/// @param residual, jacobian at the fit, whitened
Eigen::VectorXd dispersionsOf(const Likelihood& likelihood, const Variables& variables, const Eigen::VectorXd& residual,
                              const Eigen::MatrixXd& jacobian, double perReading);

} // namespace supercircle::diagnosis
