#pragma once
// Held points of one shell that contradict each other (private to step/).

#include "supercircle/step/world.h"

namespace supercircle::step {

/// Ends the motion of held points in the coming frame of `frame` s where the shell between two of them cannot follow:
/// drawn nearly straight, or both in one place. Those that the crosshead carries are left out.
void stopHeldPairs(const World& world, double frame, Rod& rod);

} // namespace supercircle::step
