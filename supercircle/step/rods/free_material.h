#pragma once
// Material laws beside the rod's own in free motion (private to step/rods). Their state within a step: age is that of
// the stage, Maxwell branches are variables of SDIRK2 as the motion is, plastic curvature stays. Where an element
// yields, the motion is left to the ordinary step, which has the flow rule.

#include "supercircle/step/rods/rod_system.h"

namespace supercircle::step {

/// The state at the start of the step.
void beginMaterial(const Rod& rod, FreeWork& f);
/// The start of a stage, of its Maxwell branches.
void startMaterial(std::size_t stage, FreeWork& f);
/// Overstress at the rates of a stage: dz/dt = d kappa/dt - z / time by backward Euler.
void relax(const Rod& rod, double tau, FreeStage& s);
/// Sets the overstress and adds its forces, N m^2.
void addRelaxing(const Rod& rod, double tau, FreeStage& s, Eigen::VectorXd& force);
/// Adds what it brings to the matrix of a stage.
void addRelaxingTangent(const Rod& rod, double tau, Eigen::MatrixXd& A);
/// Whether an element yields in a stage that was solved, `first` and `second` s from the start of the step.
[[nodiscard]] bool yields(const Rod& rod, const FreeWork& f, double first, double second);
/// Energy of bending, J: that of the rod's own law or of the material's, and of the overstress of its branches.
[[nodiscard]] double bentEnergy(const Rod& rod, const Eigen::VectorXd& q, const std::vector<double>& overstress,
                                double ahead);
/// What branches and softening took in the step of its own of `size` s from `start` s on.
void takeMaterial(const Rod& rod, double start, double size, FreeWork& f);
/// Moves the state of the rod's effects over a step, in which their viscosity took `damped` J. Returns what they took.
double acceptMaterial(Rod& rod, double dt, double damped, const FreeWork& f);

} // namespace supercircle::step
