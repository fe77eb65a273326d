#pragma once
// What detection works on: a curve cut into pieces that turn by at most a quarter, and its sample points.

#include "supercircle/contact/geometry.h"

#include <vector>

namespace supercircle::contact {

/// A stretch of one arc that turns by at most 90 degrees, so that a point has at most one closest point in its
/// interior. The end frame (p1, t1) is bit for bit the start frame of the next piece: two neighbours decide by the same
/// number which of them owns a closest point, so that there is neither a gap nor a duplicate at joints.
struct Piece {
    Vec2 p0 = Vec2::Zero(); ///< start, m
    Vec2 t0 = Vec2::Zero(); ///< unit tangent at the start
    Vec2 p1 = Vec2::Zero(); ///< end, m
    Vec2 t1 = Vec2::Zero(); ///< unit tangent at the end
    double curvature = 0.0; ///< 1/m
    double length = 0.0;    ///< m
    double s0 = 0.0;        ///< arc length of the start along the rod, m
    double span = 0.0;      ///< length of the whole element, m
    std::int32_t element = 0;
    std::int32_t part = 0; ///< which piece of its element
};

/// A point of the rod that is projected on others: an element node, a tip, or the mid-rod point.
struct Sample {
    Vec2 p = Vec2::Zero();
    Vec2 t = Vec2::Zero(); ///< unit tangent of the rod there
    double s = 0.0;        ///< arc length along the rod, m
    std::int32_t element = 0;
    double curvature = 0.0; ///< of the rod there (mean of both sides at a node), 1/m
    std::int32_t index = 0; ///< node number, or kMidSample
    bool tip = false;
};

constexpr std::int32_t kMidSample = 2047;

/// A curve prepared for detection.
struct RodShape {
    std::vector<Piece> pieces;
    std::vector<Sample> samples;
    std::vector<double> turn;   ///< pieces.size() + 1: angle turned from the start of the rod, rad
    double midS = -1.0;         ///< arc length of the mid sample, -1 if it is a node, m
    double endS = 0.0;          ///< arc length of the end, the very number of its tip sample, m
    double length = 0.0;        ///< m
    double halfThickness = 0.0; ///< m
    bool closed = false;
};

/// How many pieces an arc is cut into.
std::int32_t pieceCount(const Arc& arc);
/// One piece of a curve, the same digits as in `prepare`.
Piece pieceOf(const Curve& curve, std::int32_t element, std::int32_t part);
/// All pieces and samples; reuses the storage of `shape`. Throws std::invalid_argument with the rod's key when the
/// curve is malformed or not finite.
void prepare(const Curve& curve, RodShape& shape);
/// The sample of a curve at (element, s): an element node (both neighbours agree to rounding) or the mid-rod point.
Sample sampleAt(const Curve& curve, std::int32_t element, double s);

} // namespace supercircle::contact
