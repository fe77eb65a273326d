#pragma once
// A shell as a thick curve: exact geometric queries (private to plugin/api).
//
// A shell is the set of points within half the thickness of its centre line. Its boundary is a part of the arcs' offset
// curves and of half circles at the ends; the offset curves join at the nodes because the tangent is continuous. All of
// these curves lie in the shell, so a ray from outside enters at its first intersection with them. Parts of the curves
// inside the shell (thickness above the radius) need not be removed.

#include "supercircle/contact/circular_arc.h"
#include "supercircle/step/world.h"

#include <vector>

namespace supercircle {

struct ThickCurve {
    std::vector<contact::crossing_check::CircularArc> pieces;
    std::vector<double> middleS; ///< arc length along the rod at the middles of the pieces, m
    double half = 0.0;           ///< half the thickness, m
    double length = 0.0;         ///< m
    rod::Vec2 first = rod::Vec2::Zero();
    rod::Vec2 last = rod::Vec2::Zero();
    rod::Vec2 lower = rod::Vec2::Zero(); ///< of a box that contains the shell (not the smallest), m
    rod::Vec2 upper = rod::Vec2::Zero();
};

/// Fills `out`, reusing its storage.
void thicken(const step::Rod& rod, ThickCurve& out);

/// The point of the centre line closest to p.
struct CentrePoint {
    rod::Vec2 point = rod::Vec2::Zero();
    rod::Vec2 left = rod::Vec2::UnitY(); ///< unit normal there, on the left of the tangent
    double distance = 0.0;               ///< m
    double s = 0.0;                      ///< arc length along the rod, m
};
CentrePoint closestOnCentreLine(const ThickCurve& curve, const rod::Vec2& p);

/// Fractions in [0, 1] of the segment from -> to at its intersections with the offset curves and end circles, sorted.
void intersections(const ThickCurve& curve, const rod::Vec2& from, const rod::Vec2& to, std::vector<double>& out);

/// Whether the shell overlaps the filled box.
bool overlapsBox(const ThickCurve& curve, const rod::Vec2& lower, const rod::Vec2& upper);

/// The smallest axis-aligned box around the shell.
void boundingBox(const ThickCurve& curve, rod::Vec2& lower, rod::Vec2& upper);

} // namespace supercircle
