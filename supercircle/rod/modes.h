#pragma once
// Small vibrations of a rod about a shape: K x = omega^2 M x, with the bending stiffness K and the mass matrix M there.
// Forces that the shape may carry are left out.

#include "supercircle/rod/kinematics.h"

#include <Eigen/Core>

namespace supercircle::rod {

/// Circular frequencies in increasing order, rad/s, of the motions x with `held` x = 0; rigid ones are left out.
/// @param q configuration, n entries
/// @param held rows of n entries; may have none
[[nodiscard]] Eigen::VectorXd circularFrequencies(const RodModel& model, const Eigen::VectorXd& q,
                                                  const Eigen::MatrixXd& held);

} // namespace supercircle::rod
