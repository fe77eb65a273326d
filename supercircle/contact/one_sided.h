#pragma once
// What the front of a one-sided edge is. Contact and the crossing check must agree on it: what comes from behind
// passes.

#include "supercircle/contact/geometry.h"

namespace supercircle::contact {

/// Whether a point lies in front of a one-sided edge, on its left. Of a joined neighbour that is nearer and beside
/// which the point lies, the side counts as well: at a ridge either side is enough, in a valley both are needed.
[[nodiscard]] bool isInFront(const Vec2& p, const Outline& edge);

/// Whether a centre line comes to an edge as near as `distance` (m); 0: whether it crosses it.
[[nodiscard]] bool reaches(const RodCurve& curve, const Outline& edge, double distance);

} // namespace supercircle::contact
