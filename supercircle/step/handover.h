#pragma once
// ESSAY TO COME

#include "supercircle/step/contact_stage.h"

namespace supercircle::step {

/// Part of each body's velocity after the host's step that is no more than the host's solver stopping early: the
/// difference between its impulses and ours on the same constraints (m/s, rad/s; per World::bodies).
std::vector<BodyMotion> unsolvedByHost(const World& world, double advanced);

/// After the host's step: decides for every dynamic body near shells whether its copy or its original is where it
/// should be. What is left between them (less than a fiftieth of a thickness as a rule) is the drift of the next frame.
void settlePlaces(World& world, Port& port, const std::vector<BodyMotion>& unsolved, double advanced);

} // namespace supercircle::step
