#pragma once
// One-sided edges carry what is in front of them, and what comes from behind passes (private to step/). A rod whose
// centre line crosses an edge is on its way: until it is through or back, it does not touch the surface of that edge
// and of those that continue it. Rod::passing holds these edges; contact, the crossing check and holds leave the pair
// out alike (excluded()). A rod that was put across an edge is no such rod but an overlap.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// After an accepted step: which one-sided edges each rod crosses. The check has seen that it came from behind.
void findPassing(World& world, const ContactStage& stage);

/// Whether a rod passes the surface that a piece belongs to.
bool passes(const World& world, const Rod& rod, const BodyOutline& piece);
/// The pairs (rod, outline) of which this is true, sorted.
void collectPassing(const World& world, std::vector<std::pair<int, int>>& pairs);

/// Whether the point of a contact with a one-sided edge was behind it at the start of the step. Contacts that lead an
/// overlap out are exempt.
bool comesFromBehind(const World& world, const contact::Candidate& c);

} // namespace supercircle::step
