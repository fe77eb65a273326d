#pragma once
// Contradictions: shells that given motions leave no room (a press that closes, a clamp driven into a floor). No motion
// of a shell satisfies them, however short the step. They are recognised and ended, because a frame that insists on
// them takes as long as it may and moves nothing. Joints and holds that are asked for more than their largest force
// break.

#include "supercircle/step/stages/trial_step.h"

namespace supercircle::step {

/// Shells for which a trial that is not feasible has no room: a body or a hold with a given motion presses, another
/// thing that does not yield presses back, and the given motion is less than a twentieth of the thickness in the trial.
void findCrushed(const World& world, const TrialStep& trial, std::vector<Crushed>& out);

/// Ends contradictions as Settings::crush says. Held points stop; a shell that a body crushes lets the body through
/// (World::passages) or leaves the motion.
void endCrushing(World& world, const Settings& settings, const std::vector<Crushed>& crushed);

/// Takes back passages whose shell is free of the body again.
void closePassages(World& world);

/// Removes holds, and marks links, whose force in the last step exceeded their largest one.
void breakOverloaded(World& world, std::vector<Broken>& out);
/// Removes the marked links.
void removeBroken(World& world);

} // namespace supercircle::step
