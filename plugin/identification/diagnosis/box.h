#pragma once
// Small quadratic problems inside a box.

#include <Eigen/Core>

namespace supercircle::diagnosis {

/// Minimises x' G x / 2 - g' x with lower <= x <= upper for a positive semidefinite G of a few rows (a ridge of 1e-12
/// of its diagonal makes it definite). Cyclic coordinate descent, exact along each coordinate, after which the free
/// ones are solved together as long as that stays inside (D. P. Bertsekas, "Nonlinear Programming", 2nd ed., 2.7).
Eigen::VectorXd boxMinimum(const Eigen::MatrixXd& G, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                           const Eigen::VectorXd& upper);

} // namespace supercircle::diagnosis
