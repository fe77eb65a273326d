#pragma once
// ESSAY TO COME

#include "supercircle/step/world.h"

namespace supercircle::step {

/// After the host's step: decides for every dynamic body near shells whether its copy or its original is where it
/// should be. What is left between them (less than a fiftieth of a thickness as a rule) is the drift of the next frame.
void settlePlaces(World& world, Port& port);

} // namespace supercircle::step
