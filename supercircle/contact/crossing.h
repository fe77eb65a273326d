#pragma once
// The crossing check: do centre lines cross each other, or enter the inside of solid outlines? It shares no code with
// detection: it uses exact arc-arc intersections and conservative advancement. An error in one of the two is thus
// noticed by the other.

#include "supercircle/contact/geometry.h"
#include "supercircle/support/parallel.h"

#include <string>
#include <vector>

namespace supercircle::contact {

struct Crossing {
    std::int32_t rodA = -1;
    std::int32_t rodB = -1; ///< -1: an outline
    std::int32_t outline = -1;
    double sA = 0.0;           ///< arc length on A, m
    Vec2 where = Vec2::Zero(); ///< m
};

/// Crossings in one configuration: centre line against centre line (also of one rod with itself), centre line against
/// two-sided segments, and centre-line points inside solid outlines.
void findCrossings(const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines,
                   std::vector<Crossing>& out);

/// Crossings during the motion from one configuration to the next (same rods and outlines, same order). Each pair is
/// sub-sampled finely enough that nothing thicker than half a thickness can pass through unnoticed.
/// Pairs whose boxes do not overlap are skipped. So are pairs of resting rods (RodCurve::resting in both
/// configurations, bitwise unchanged), and pairs of a resting rod and an outline that does not move.
void findCrossingsSwept(const std::vector<RodCurve>& before, const std::vector<RodCurve>& after,
                        const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                        std::vector<Crossing>& out, const parallel::For& loop = {});

} // namespace supercircle::contact
