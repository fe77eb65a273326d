#pragma once
// The part of a step that concerns one rod alone (private to step/): evaluate, predict, advance. Rods are independent
// of each other here, so these run in parallel bitwise identical for any number of threads.

#include "supercircle/step/stages/workspace.h"

namespace supercircle::step {

/// Mean tangent angle of the rod, rad.
[[nodiscard]] double meanAngle(const rod::RodModel& model, const rod::Kinematics& kin);
/// Turns the velocities relative to the centre of mass by `angle`.
void turnAbout(const rod::GaussField& gauss, double angle, std::vector<Vec2>& u);

/// Sets the linearisation point to the middle of the step as the present velocity predicts it, at most `farthest` (m)
/// away.
void beginAtPredictedMiddle(const Rod& rod, double dt, double farthest, RodWork& w);
/// Moves the linearisation point to the middle of the attempt just solved.
void relineariseInMiddle(const Rod& rod, RodWork& w);
/// A rod that does not move in this attempt.
void freezeRod(const Rod& rod, RodWork& w);
/// A, rhs and hold constraints at the linearisation point (stages evaluate and predict). `first`: nothing was solved in
/// this attempt yet.
void evaluateRod(const World& world, const Rod& rod, double dt, bool first, RodWork& w);
/// Velocity without contacts.
void predictRod(const Rod& rod, RodWork& w);
/// New configuration, displacement and local error from w.v.
void advanceRod(const Rod& rod, double dt, RodWork& w);
/// Energy the step moved, per rod (see energy_balance.h).
struct RodEnergies {
    double kineticChange = 0.0, bendingChange = 0.0, gravityChange = 0.0;
    double kineticLoss = 0.0;  ///< 1/2 |u_new - u_old|^2
    double secondOrder = 0.0;  ///< of implicit bending and of gravity
    double holdWork = 0.0;     ///< work of holds
    double holdInjected = 0.0; ///< part of it that closing gaps of holds and of the ring brought in
    double damping = 0.0;      ///< taken by the shell's own damping
    double loadWork = 0.0;     ///< work of forces and mouse joints
    double effects = 0.0;      ///< taken by effects
    double rollingWork = 0.0;  ///< of forces whose rows turn and roll within the step (contact_stiffness.h)
};
/// Accepts the attempt: state, material velocities, hold reactions.
RodEnergies acceptRod(const World& world, Rod& rod, double dt, RodWork& w);

} // namespace supercircle::step
