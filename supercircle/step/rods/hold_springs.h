#pragma once
// Clamps that yield (private to step/): the section is tied to its direction by a spring, torque = k (goal - angle).
// The angle of a section is linear in q, so that the spring is a constant stiffness k a a' with the row a of the angle,
// at the very place of the clamp. A softer arc beside it would be half an arc off.

#include "supercircle/step/stages/workspace.h"

namespace supercircle::step {

/// Adds them to A and rhs of an ordinary step: implicit, at the end of it.
void addHoldSprings(const World& world, const Rod& rod, double dt, RodWork& w);
/// Adds factor * d2E/dq2 to `matrix`.
void addHoldSpringStiffness(const Rod& rod, const rod::Kinematics& kin, double factor, Eigen::MatrixXd& matrix);
/// Adds their force at `kin`, `ahead` s after World::time, times `factor`.
void addHoldSpringForce(const World& world, const Rod& rod, const rod::Kinematics& kin, double ahead, double factor,
                        Eigen::VectorXd& force);
/// Stored in them, J.
[[nodiscard]] double holdSpringEnergy(const World& world, const Rod& rod, const rod::Kinematics& kin, double ahead);
/// Torque on the rod, N m; 0 where the clamp does not yield.
[[nodiscard]] double torqueOfHoldSpring(const World& world, const Rod& rod, const Hold& hold,
                                        const rod::Kinematics& kin, double ahead);

} // namespace supercircle::step
