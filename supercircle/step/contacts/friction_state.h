#pragma once
// Friction coefficients that depend on the state of surfaces and on the speed of slip (private to step/; the laws are
// in effects/surface.h).
//
// The speed is that of the linearisation before: of the last step at first, then a mean of the last two guesses, which
// also converges where friction rises gently with speed. A coefficient that is off by more than a thousandth asks for
// another linearisation.
//
// Where friction grows with the speed, that does not end: a coefficient that is a little too small lets a contact
// creep by its whole elastic displacement in one step, at which speed it is far too large, and the next guess sticks
// (an arch that relaxed by creep of its feet took 280 000 steps instead of 3000, and its force was off by a tenth).
// There the coefficient is found by false position, each contact between bounds of its own (M. Dowell, P. Jarratt, BIT
// 11 (1971) 168), solving the contacts again and nothing else.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// Factor of a contact's friction coefficient at the end of a step in which it does not slip.
double factorAtRest(const World& world, const contact::Candidate& candidate, double dt);
/// Multiplies the friction coefficients of the candidates' contacts; `again`: further linearisations of the same step.
void applyFrictionState(const World& world, const std::vector<RodWork>& rods, double dt, bool again,
                        ContactStage& stage);
/// At the solved speeds: changes the coefficients that grow with speed and are off; false if none is.
bool refineFriction(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage);
/// How far friction is from what its state says at the solved speeds, in tolerances.
double frictionError(const World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage);
/// Moves the surfaces through the step.
void advanceSurfaces(World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage);

} // namespace supercircle::step
