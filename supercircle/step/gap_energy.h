#pragma once
// What closing gaps may bring in (private to step/).
//
// A gap closes at a given speed (gap_closing.h), whatever force that takes. Gaps that contradict each other take any
// force: a rope that is shorter than what lies between its ends pulls against a contact that pushes, and their work has
// no bound. So gaps may bring in as much as the alarm on a frame allows (energy_gain.h). Those that would bring in more
// are left open, in a trial that shows what force they carry then. A crate that hangs from a joint weighs as much
// whether its gap closes or not, and the joint lifts it. What pulls because it closes does so by the share that is
// allowed, and waits for the next frame (decision 0247).

#include "supercircle/step/stages/trial_step.h"

namespace supercircle::step {

/// Judges the gaps of a trial in a frame that began with the balance `before`. True: the trial is to be made again with
/// other gaps left open (ContactStage::gaps; ways of bodies to their originals are stopped in the world).
/// @param last no further trial may be made: what is suspected waits, so that the frame does not end without a step
[[nodiscard]] bool judgeGaps(const EnergyBalance& before, const Settings& settings, bool last, World& world,
                             TrialStep& t);

/// After a step that was accepted: gaps that closed by a share have used up what the frame allows, and wait.
void endShares(World& world, TrialStep& t);

} // namespace supercircle::step
