#pragma once
// Reference shapes of rods and outlines, for boxes and lists of checks that are enlarged for future motion. The lists
// stay complete until a rod or outline has moved out of its enlarged box.

#include "supercircle/contact/detection/outline_pair.h"
#include "supercircle/contact/detection/rod_pair.h"

#include <vector>

namespace supercircle::contact {

struct Box {
    Vec2 low = Vec2::Constant(1e300);
    Vec2 high = Vec2::Constant(-1e300);
    void include(const Vec2& p, double r) {
        low = low.cwiseMin(p - Vec2::Constant(r));
        high = high.cwiseMax(p + Vec2::Constant(r));
    }
    [[nodiscard]] Box enlarged(double r) const { return {low - Vec2::Constant(r), high + Vec2::Constant(r)}; }
};

inline bool overlap(const Box& a, const Box& b) {
    return a.low.x() <= b.high.x() && b.low.x() <= a.high.x() && a.low.y() <= b.high.y() && b.low.y() <= a.high.y();
}

/// Bounds of a sub-arc: a chord with height `sagitta` (m) of the arc above it, inside a circle about `middle`.
struct SubArcBound {
    Vec2 p0 = Vec2::Zero();
    Vec2 p1 = Vec2::Zero();
    Vec2 middle = Vec2::Zero();
    double radius = 0.0;
    double sagitta = 0.0;
};

struct ReferenceShape {
    std::vector<SubArcBound> subArcs;
    std::vector<Vec2> tangents;  ///< at the start of every sub-arc and at the end
    std::vector<Vec2> samples;   ///< positions, m
    std::vector<double> lengths; ///< of the sub-arcs, m
    std::vector<double> starts;  ///< arc lengths of the starts of the sub-arcs, m
    std::vector<double> sampleS; ///< arc lengths of the samples, m
    Box box;                     ///< of the centre line
    double totalTurn = 0.0;      ///< range of the tangent angle, rad
};

void setReference(const RodShape& rod, ReferenceShape& reference);

/// Upper bound of the displacement of any centre-line point since the reference, m; infinite if the sub-arcs differ.
/// With displacements a of nodes and b of tangents, the interpolating cubic moves by at most max a + 4/27 l (b0 + b1).
/// The deviation of a quarter arc from its cubic is covered by using 0.4 instead of 8/27.
double displacement(const RodShape& rod, const ReferenceShape& reference);

/// Lists the features of two rods (or of one with itself) whose centre lines can come within `reach` (m).
void collectChecks(const ReferenceShape& a, const ReferenceShape& b, double reach, RodPairChecks& checks);
void collectSelfChecks(const ReferenceShape& rod, double reach, RodPairChecks& checks);
/// Lists the features of a rod that can come within `reach` (m) of an outline.
void collectChecks(const ReferenceShape& rod, const OutlineShape& outline, double reach, OutlinePairChecks& checks);

/// Box of an outline, radius included.
Box boxOf(const OutlineShape& outline, const OutlinePoints& points);

} // namespace supercircle::contact
