#pragma once
// Pairs of a shell and a piece of a host body that the user's filter keeps apart (private to step/).

#include "supercircle/step/stepper.h"

namespace supercircle::step {

/// Asks the filter about the pairs that may meet in the coming frame (s): World::vetoes. Where an answer changes,
/// candidates are found anew and the shell wakes. An empty filter vetoes nothing.
void updateVetoes(World& world, double frame, const PairFilter& filter);
/// Whether a rod and a piece are kept apart in this frame.
bool vetoed(const World& world, const Rod& rod, const BodyOutline& piece);

} // namespace supercircle::step
