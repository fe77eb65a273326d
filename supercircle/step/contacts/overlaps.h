#pragma once
// Pairs that overlap (World::overlaps): they leave the law of contact, and a soft push moves them apart (private to
// step/).
//
// The push is a damper at each of the pair's places (contact::wayOut): force = c (speed - u), u the relative velocity
// along its direction, never a pull. It is implicit, acts on both sides, and ends at c * speed whatever holds the pair.
// In the contact problem it is a frictionless contact whose gap opens at `speed` less r / (c dt), the velocity of one
// more unknown. What it brings in is EnergyBalance::injected.contact. Only worlds with overlaps pay for any of this.

#include "supercircle/step/contacts/contact_rows.h"

namespace supercircle::step {

/// The pair of a crossing, without its way out.
Overlap overlapOf(const World& world, const contact::Crossing& crossing);
/// Whether a pair overlaps in the present configuration of the world.
bool overlapsNow(const World& world, const Overlap& pair);
/// Whether a pair is in World::overlaps; `apart`: and its contacts do not act.
bool isOverlap(const World& world, int rodA, int rodB, int outline, bool apart);

/// Whether a rod lies in another piece of the joined surface that an outline is part of: what is hidden there has had
/// no contacts, so that the rod may come out deep in this one.
bool withinJoined(const World& world, int rod, int outline);

/// Adds pairs; their shells wake.
void addOverlaps(World& world, const std::vector<Overlap>& pairs);
/// Finds the way out of each overlap from where things are. `frameBegins`: those that are free leave the list.
void reviewOverlaps(World& world, bool frameBegins);

/// Damping of a contact of such a pair, N s/m: normals of a rod that lies round a corner may contradict each other, and
/// rigid rows would bend it as fast as they say.
double contactDamping(const World& world, const std::vector<RodWork>& rods, const contact::Candidate& c);

/// Which pushes take part in this linearisation, and their geometry: stage.pushes.rows.
void prepareOverlaps(const World& world, const std::vector<RodWork>& rods, double dt, ContactStage& stage);
/// Fills the last contacts of the problem, without what makes them soft.
void coupleOverlaps(const World& world, const std::vector<RodWork>& rods, ContactStage& stage);
/// Makes pushes and contacts with a damping soft: one more unknown each. After every other row, because it widens them.
void softenOverlaps(double dt, ContactStage& stage);
/// Energy and impulses of the pushes; the counterpart of recordContacts.
void recordOverlaps(World& world, std::vector<RodWork>& rods, const ContactStage& stage, double dt);

} // namespace supercircle::step
