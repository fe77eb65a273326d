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

/// What the check of a motion took, and when it gives up.
struct CheckEffort {
    double maxWork = 0.0;                ///< limit of units(), 0: none; beyond it the check ends unfinished
    double pairs = 0.0;                  ///< pairs of arcs whose boxes meet
    double samples = 0.0;                ///< places on their ways where pairs of arcs were intersected
    bool bounded = false;                ///< leave out pairs whose ways take too many samples ...
    std::vector<Crossing> unjudged = {}; ///< ... which stand here: a shorter step is needed to know

    void add(const CheckEffort& part) {
        pairs += part.pairs;
        samples += part.samples;
        unjudged.insert(unjudged.end(), part.unjudged.begin(), part.unjudged.end());
    }
    /// In samples, about 0.5 us each. Weights: see step/stages/work_count.h.
    [[nodiscard]] double units() const { return samples + 3.0 * pairs; }
    [[nodiscard]] bool unfinished() const { return maxWork > 0.0 && units() > maxWork; }
};

/// Crossings during the motion from one configuration to the next (same rods and outlines, same order). Each pair is
/// sub-sampled finely enough that nothing thicker than half a thickness can pass through unnoticed.
/// Pairs whose boxes do not overlap are skipped. So are pairs of resting rods (RodCurve::resting in both
/// configurations, bitwise unchanged), and pairs of a resting rod and an outline that does not move. At one-sided edges
/// what crosses at the start counts, and what comes from the front.
/// What `effort` leaves out or does not finish is not known to be free of crossings.
void findCrossingsSwept(const std::vector<RodCurve>& before, const std::vector<RodCurve>& after,
                        const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                        std::vector<Crossing>& out, const parallel::For& loop = {}, CheckEffort* effort = nullptr);

} // namespace supercircle::contact
