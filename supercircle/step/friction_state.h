#pragma once
// Friction coefficients that depend on the state of surfaces and on the speed of slip (private to step/; the laws are
// in effects/surface.h).
//
// The speed is that of the linearisation before: of the last step at first, then a mean of the last two guesses, which
// also converges where friction rises steeply with speed. A coefficient that is off by more than a thousandth asks for
// another linearisation.

#include "supercircle/step/contact_stage.h"

namespace supercircle::step {

/// Multiplies the friction coefficients of the candidates' contacts; `again`: further linearisations of the same step.
void applyFrictionState(const World& world, const std::vector<RodWork>& rods, double dt, bool again,
                        ContactStage& stage);
/// How far friction is from what its state says at the solved speeds, in tolerances.
double frictionError(const World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage);
/// Moves the surfaces through the step.
void advanceSurfaces(World& world, const std::vector<RodWork>& rods, double dt, const ContactStage& stage);

} // namespace supercircle::step
