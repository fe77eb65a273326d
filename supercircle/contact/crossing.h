#pragma once
// The independent witness: do centre lines cross each other or leave the solid outlines' outside? Shares no code with
// detection (it works on its own exact arc-arc intersections and a swept sub-sampling), so that a blind spot of one is
// seen by the other.

#include "supercircle/contact/geometry.h"
#include "supercircle/support/parallel.h"

#include <string>
#include <vector>

namespace supercircle::contact {

struct Crossing {
    std::int32_t rodA = -1;
    std::int32_t rodB = -1; ///< -1: an outline
    std::int32_t outline = -1;
    double sA = 0.0; ///< arc length on A, m
    Vec2 where = Vec2::Zero();
};

/// Crossings in one configuration: centre line against centre line (a rod with itself included), centre line against
/// two-sided segments, and centre-line points inside solid outlines.
void findCrossings(const std::vector<Curve>& curves, const std::vector<Outline>& outlines, std::vector<Crossing>& out);

/// Crossings anywhere on the way from one configuration to the next (same rods, same order): the motion is sub-sampled
/// finely enough, pair by pair, that nothing thicker than half a thickness can pass through unseen.
/// `outlinesBefore` and `outlinesAfter` likewise. Pairs that cannot have met are skipped by their boxes; pairs
/// of rods that rest (Curve::resting in both, not a digit changed), or of one and an outline that does not move, too.
void findCrossingsSwept(const std::vector<Curve>& before, const std::vector<Curve>& after,
                        const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                        std::vector<Crossing>& out, const parallel::For& loop = {});

} // namespace supercircle::contact
