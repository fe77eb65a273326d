#pragma once
// Frozen copies of rods and outlines with an allowance for motion: from them the lists of checks are made, which stay
// complete until somebody has moved out of his allowance.

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
    [[nodiscard]] Box grown(double r) const { return {low - Vec2::Constant(r), high + Vec2::Constant(r)}; }
};

inline bool overlap(const Box& a, const Box& b) {
    return a.low.x() <= b.high.x() && b.low.x() <= a.high.x() && a.low.y() <= b.high.y() && b.low.y() <= a.high.y();
}

/// A piece as bounds see it: a chord that bulges by `sagitta`, inside a circle about `middle`.
struct PieceBound {
    Vec2 p0 = Vec2::Zero();
    Vec2 p1 = Vec2::Zero();
    Vec2 middle = Vec2::Zero();
    double radius = 0.0;
    double sagitta = 0.0;
};

struct RodSnapshot {
    std::vector<PieceBound> pieces;
    std::vector<Vec2> tangents;  ///< at the start of every piece and at the end
    std::vector<Vec2> samples;   ///< positions
    std::vector<double> lengths; ///< of the pieces
    std::vector<double> starts;  ///< arc lengths where the pieces start
    std::vector<double> sampleS; ///< arc lengths of the samples
    Box box;                     ///< of the centre line
    double totalTurn = 0.0;      ///< range of the tangent angle, rad
};

void takeSnapshot(const RodShape& rod, RodSnapshot& snapshot);

/// A bound on how far any centre-line point has moved since the snapshot; infinite if the pieces are not the same ones.
/// With displacements a of nodes and b of tangents, the cubic that interpolates them moves by at most
/// max a + 4/27 l (b0 + b1); what an arc of up to a quarter turn adds to its cubic is far below the 0.4 used for 8/27.
double displacement(const RodShape& rod, const RodSnapshot& snapshot);

/// Everything of two rods (or of one and itself) that can come within `reach` of centre lines.
void collectChecks(const RodSnapshot& a, const RodSnapshot& b, double reach, RodPairChecks& checks);
void collectSelfChecks(const RodSnapshot& rod, double reach, RodPairChecks& checks);
/// Everything of a rod that can come within `reach` of an outline.
void collectChecks(const RodSnapshot& rod, const OutlineShape& outline, double reach, OutlinePairChecks& checks);

/// Box of an outline, radius included.
Box boxOf(const OutlineShape& outline, const OutlinePoints& points);

} // namespace supercircle::contact
