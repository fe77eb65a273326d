#pragma once
// Pairs whose contacts are left out of a step (private to step/).

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// Pairs that do not collide because they are joined or one passes through the other, sorted; see excluded().
void collectExcluded(const World& world, ContactStage& stage);
/// Whether the contacts of this pair are left out: vetoed, joined or apart.
bool excluded(const World& world, const ContactStage& stage, int rodA, int rodB, int outline);

} // namespace supercircle::step
