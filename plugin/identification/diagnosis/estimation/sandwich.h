#pragma once
// How much wider an interval has to be than the misfit's curvature says.
//
// Where the model is right, a number's information (the curvature) and the scatter of its score over independent
// stretches of the recordings are the same. Where it is not - a second effect that is not named, another simulator's
// arithmetic, noise that remembers longer than was thought - stretches pull the number to different values, and the
// scatter is larger: of five pairs of which one effect was named, two held the truth. The scatter is taken over
// strokes of runs, force and markers apart, corrected for what each has pulled the fit to itself (without that, a
// stroke that alone shows an effect agrees with itself), and mixed with what the model promises where few say
// something; as it is estimated from few, Student's quantile takes the place of the normal one (Satterthwaite's degrees
// of freedom). Markers that fit well beside a force that does not made the mean square per row a poor measure of that.
//
// Sources: H. White, Econometrica 50 (1982) 1; R. M. Bell, D. F. McCaffrey, Survey Methodology 28 (2002) 169 (the
// correction).

#include "plugin/identification/diagnosis/fit.h"

#include <Eigen/Core>

namespace supercircle::diagnosis {

constexpr double k90 = 1.6448536269514722; ///< quantile of a normal distribution: 90 % lie within it

/// Variance of each of x over the one that noise of the stated size gives it, such that a normal quantile of 90 %
/// holds; at least 1 and the misfit's mean square per row.
/// @param residual, jacobian at the fit, whitened
Eigen::VectorXd dispersionsOf(const Misfit& misfit, const Variables& variables, const Eigen::VectorXd& residual,
                              const Eigen::MatrixXd& jacobian, double perRow);

} // namespace supercircle::diagnosis
