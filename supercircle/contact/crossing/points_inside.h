#pragma once
// Points of centre lines inside solid outlines or just behind one-sided edges, for the crossing check: a rod that lies
// wholly inside crosses no face.

#include "supercircle/contact/crossing.h"
#include "supercircle/contact/crossing/swept_motion.h"

namespace supercircle::contact::crossing_check {

template <class A, class B>
[[nodiscard]] bool mayTouch(const A& a, const B& b) {
    if (a.group == b.group && a.group != 0)
        return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

/// Ends and middles of elements inside solids or just behind one-sided edges; one report per rod and outline. After a
/// motion, whose start is `before`, only points count that came through the edge. Rods at rest and outlines at rest
/// are left out if `skipStill`.
void findInside(const std::vector<RodCurve>& curves, const SweptMotion& motion, const std::vector<Outline>& before,
                const std::vector<Outline>& outlines, const std::vector<char>& outlineMoves, bool skipStill,
                std::vector<Crossing>& out);

} // namespace supercircle::contact::crossing_check
