#pragma once
// Small quadratic programs with bounds.

#include <Eigen/Core>

namespace supercircle::diagnosis {

/// Minimises x' G x / 2 - g' x subject to lower <= x <= upper. G is positive semidefinite with a few rows; a ridge of
/// 1e-12 of its diagonal makes it definite. Cyclic coordinate descent, exact along each coordinate; coordinates off
/// their bounds are then solved together while that stays feasible.
/// Source: D. P. Bertsekas, "Nonlinear Programming", 2nd ed., 2.7.
Eigen::VectorXd solveBoxQp(const Eigen::MatrixXd& G, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                           const Eigen::VectorXd& upper);

} // namespace supercircle::diagnosis
