#pragma once
// What detection promises of its candidates, asserted.

#include "supercircle/contact/detection.h"

namespace supercircle::contact {

/// Sides, normal, gap and reach of one candidate.
void assertSound(const Candidate& c, const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines,
                 double margin);
[[nodiscard]] bool idsAreUnique(const std::vector<Candidate>& list);

} // namespace supercircle::contact
