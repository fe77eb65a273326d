#pragma once
// Circular arcs for the crossing check: exact intersections and distances. This code is independent of detection on
// purpose, so that an error in one of them is noticed by the other.

#include "supercircle/contact/geometry.h"

#include <array>

namespace supercircle::contact::crossing_check {

/// A circular arc or straight segment, given at its middle. Its tangent rotates by at most about kMaxTurn.
struct CircularArc {
    Vec2 mid = Vec2::Zero();
    Vec2 tangent = Vec2::UnitX(); ///< at the middle
    double curvature = 0.0;       ///< 1/m
    double half = 0.0;            ///< half its arc length, m
    Vec2 start = Vec2::Zero();    ///< the ends, at arc lengths -half and +half
    Vec2 end = Vec2::Zero();
    Vec2 apex = Vec2::Zero(); ///< intersection of the end tangents: the arc lies in the triangle start, end, apex
    double cosine = 1.0;      ///< of the rotation of the tangent from the middle to an end
    double reach = 0.0;       ///< the sine of that angle over the curvature: half the chord, m

    [[nodiscard]] Vec2 at(double s) const; ///< s from the middle, m
};

constexpr double kMaxTurn = 2.0; // rad; longer arcs are divided, so that tan(turn/4) stays below 0.55

/// The arc with this middle (m), tangent angle there (rad), curvature (1/m) and half length (m).
CircularArc makeArc(const Vec2& mid, double angle, double curvature, double half);
/// The same, given by its start and the tangent angle at its middle.
CircularArc makeArcFromStart(const Vec2& start, double angle, double curvature, double half);

struct Intersection {
    double sA = 0.0; ///< from A's middle, m
    Vec2 where = Vec2::Zero();
};

/// Intersections of two arcs, each prolonged by `extra` (m) at both ends: 0, 1 or 2. Overlapping arcs of one and the
/// same circle have one intersection, in the middle of the overlap.
int intersect(const CircularArc& a, const CircularArc& b, double extra, std::array<Intersection, 2>& out);

/// Distance of two arcs, 0 when they intersect, m.
double distance(const CircularArc& a, const CircularArc& b);

/// Distance of a point from an arc, m.
double distance(const Vec2& p, const CircularArc& b);

/// Lower bound of the distance of two arcs from the separating axes along and across their chords, m; 0 if these do not
/// separate them. Uses no trigonometry.
double separation(const CircularArc& a, const CircularArc& b);

} // namespace supercircle::contact::crossing_check
