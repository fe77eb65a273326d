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

/// Whether contacts of a trial press with a million times what their shells weigh and resist bending with. No shell has
/// room for a motion that does.
[[nodiscard]] bool forcesDiverge(const World& world, const TrialStep& trial);

/// Adds those that the list does not have.
void addCrushed(std::vector<Crushed>& list, const std::vector<Crushed>& more);

/// Ends contradictions as Settings::crush says: held points stop, a crushed shell leaves the motion, or the frame has
/// to end because a body or the crosshead must stop. True: the latter.
bool endCrushing(World& world, const Settings& settings, const std::vector<Crushed>& crushed);

/// What crushes rods stands in the frames to come (World::stopped).
void stopBodies(World& world, const std::vector<Crushed>& crushed);
/// What has stood long enough may go on: the shells may have made room.
void endStops(World& world);
/// Whether the crosshead stands in this frame.
[[nodiscard]] bool crossheadStands(const World& world);
/// Leaves `b`, as read from the host, where its copy `old` is, if it must stand. One that turns back moves.
void standStill(const World& world, const Body& old, Body& b);
/// The bodies that stand do so in the host's coming step; those that have turned back are forgotten.
void stopInHost(World& world, Port& port);
/// Gives them back their velocities after that step.
void resumeInHost(const World& world, Port& port);

/// Removes holds, and marks links, whose force in the last step exceeded their largest one.
void breakOverloaded(World& world, std::vector<Broken>& out);
/// Removes the marked links.
void removeBroken(World& world);

} // namespace supercircle::step
