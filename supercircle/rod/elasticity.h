#pragma once
// Bending energy of a Kirchhoff rod: E_b = 1/2 B sum_i l_i (kappa_i - kappa0_i)^2. It is exact for arcs and quadratic
// in the curvatures.

#include "supercircle/rod/model.h"

#include <Eigen/Core>

namespace supercircle::rod {

/// Stored bending energy, J.
double bendingEnergy(const RodModel& model, const Eigen::VectorXd& q);
/// Bending energy of one element, J.
double bendingEnergy(const RodModel& model, const Eigen::VectorXd& q, int element);
/// Adds the bending force -dE/dq to `force` (n entries).
void addBendingForce(const RodModel& model, const Eigen::VectorXd& q, Eigen::VectorXd& force);
/// Diagonal entry of d2E/dq2 of an element's curvature: B l, N m^3.
inline double bendingStiffness(const RodModel& model, int element) {
    return model.definition().bendingModulus * model.elementLength(element);
}

} // namespace supercircle::rod
