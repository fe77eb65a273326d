#pragma once
// What is joined to a host body alone goes with it when its user puts the body somewhere else: a joint that opened by
// the whole way would close slowly, or as a blow. Shells that a joint ties to the body, and those that joints tie to
// them, are moved by the same rigid motion, unless a hold, a joint to the world or to another body ties one of them.

#include "supercircle/step/world.h"

namespace supercircle::step {

/// Moves a rod rigidly as a body is moved from one state to another one. Its velocity relative to the body turns with
/// it. Contacts are forgotten; the change of its energy is booked as added.
void carryRod(World& world, std::size_t index, const BodyState& from, const BodyState& to);

/// A joint with the body is made where the body is now: ways that its user moved it before carry nobody.
void meetBody(World& world, BodyId id, const BodyState& now);

} // namespace supercircle::step
