#pragma once
// Effects of the catalogue inside a step (private to step/), as far as they concern one rod: material laws beside the
// linear bending, planar drag and air.
//
// Both are laws of the configuration at the end of the step. They enter A and the right-hand side linearised at the end
// as predicted, q* = 2 q_k - q, so that the first linearisation is a prediction from the last velocity and every
// further one a Newton step; a law that is off by more than its tolerance asks for another one. What an effect took is
// booked as the law says at the end (stored, dissipated); the difference to the work of the linearised force is second
// order in the step and goes to `numerical`, as that of implicit bending does.
// The linear bending stays where it is: effects add what differs from it, so that without effects not a digit changes.

#include "supercircle/step/stages/workspace.h"

namespace supercircle::step {

/// Adds the effects on a rod to A and rhs. `again`: further linearisations of the same step.
void addEffects(const Rod& rod, double dt, bool again, RodWork& w);
/// How far the laws are from their linearisation, in tolerances; above 1 another one is worth while.
double effectError(const Rod& rod, double dt, const RodWork& w);

struct EffectEnergyChange {
    double taken = 0.0;       ///< change of stored energy plus dissipation, J
    double secondOrder = 0.0; ///< J
};
/// Moves the effects' state to the end of the step.
EffectEnergyChange acceptEffects(Rod& rod, double dt, const RodWork& w);

} // namespace supercircle::step
