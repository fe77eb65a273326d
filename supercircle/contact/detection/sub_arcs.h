#pragma once
// Working data of detection: a curve divided into sub-arcs that rotate by at most a quarter turn, and its sample
// points.

#include "supercircle/contact/geometry.h"

#include <vector>

namespace supercircle::contact {

/// A part of one arc that rotates by at most 90 degrees, so that a point has at most one closest point in its interior.
/// The end frame (p1, t1) is bitwise the start frame of the next sub-arc. Two neighbours thus decide by the same
/// numbers which of them owns a closest point, and nodes cause neither gaps nor duplicates.
struct SubArc {
    Vec2 p0 = Vec2::Zero(); ///< start, m
    Vec2 t0 = Vec2::Zero(); ///< unit tangent at the start
    Vec2 p1 = Vec2::Zero(); ///< end, m
    Vec2 t1 = Vec2::Zero(); ///< unit tangent at the end
    double curvature = 0.0; ///< 1/m
    double length = 0.0;    ///< m
    double s0 = 0.0;        ///< arc length of the start along the rod, m
    double span = 0.0;      ///< length of the whole element, m
    std::int32_t element = 0;
    std::int32_t part = 0; ///< which sub-arc of its element
};

/// A point of the rod that is projected on other rods: an element node, a tip, or the mid-rod point.
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
    std::vector<SubArc> subArcs;
    std::vector<Sample> samples;
    std::vector<double> turn;   ///< subArcs.size() + 1 tangent angles relative to the start of the rod, rad
    double midS = -1.0;         ///< arc length of the mid sample, -1 if it is a node, m
    double endS = 0.0;          ///< arc length of the end, bitwise that of its tip sample, m
    double length = 0.0;        ///< m
    double halfThickness = 0.0; ///< m
    bool closed = false;
};

/// Number of sub-arcs of an arc.
std::int32_t subArcCount(const Arc& arc);
/// One sub-arc of a curve, bitwise as in `prepare`.
SubArc subArcOf(const RodCurve& curve, std::int32_t element, std::int32_t part);
/// Computes all sub-arcs and samples; reuses the storage of `shape`. Throws std::invalid_argument with the rod's key
/// when the curve is malformed or not finite.
void prepare(const RodCurve& curve, RodShape& shape);
/// The sample of a curve at (element, s): an element node (both neighbours agree to round-off) or the mid-rod point.
Sample sampleAt(const RodCurve& curve, std::int32_t element, double s);

} // namespace supercircle::contact
