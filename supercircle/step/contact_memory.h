#pragma once
// Forces remembered from step to step by contact id (private to step/).

#include "supercircle/step/world.h"

namespace supercircle::step {

/// Entry of contact `id` in a list sorted by id, nullptr if there is none.
const ContactImpulse* findImpulse(const std::vector<ContactImpulse>& list, std::uint64_t id);

void sortById(std::vector<ContactImpulse>& list);

/// Ids of candidates in rising order; `ids` is overwritten.
void sortedIds(const std::vector<contact::Candidate>& candidates, std::vector<std::uint64_t>& ids);

/// Force (N) a candidate carried before. The minimum of two elements that rolled over a joint is a new feature of the
/// same contact: it inherits the force of neighbouring minima that are no longer there. Without that, a nearly
/// conformal contact that sits at a joint starts each step without its rolling stiffness and hops to and fro for ever.
/// `list` and `present` (ids of all candidates) are sorted.
ContactImpulse forceBefore(const std::vector<ContactImpulse>& list, const std::vector<std::uint64_t>& present,
                           const contact::Candidate& c);

} // namespace supercircle::step
