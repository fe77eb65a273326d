#pragma once
// A shell as a thick curve: exact answers to geometric questions (private to shells/).
//
// The body of a shell is all that is no farther than half the thickness from its centre line. Its boundary consists of
// the arcs' offset curves and of half circles at the ends: at joints the tangent is continuous, so there the offset
// curves join. A ray therefore enters at the first of its meetings with these curves, whatever parts of them lie inside
// the body; where offset curves overtake each other (thickness above the radius) nothing has to be cut away.

#include "supercircle/contact/crossing_piece.h"
#include "supercircle/step/world.h"

#include <vector>

namespace supercircle {

struct ThickCurve {
    std::vector<contact::witness::Piece> pieces;
    std::vector<double> middleS; ///< arc length along the rod of the pieces' middles, m
    double half = 0.0;           ///< half the thickness, m
    double length = 0.0;         ///< m
    rod::Vec2 first = rod::Vec2::Zero();
    rod::Vec2 last = rod::Vec2::Zero();
    rod::Vec2 lower = rod::Vec2::Zero(); ///< of a box that contains the body (not the smallest), m
    rod::Vec2 upper = rod::Vec2::Zero();
};

/// Fills `out`, reusing its storage.
void thicken(const step::Rod& rod, ThickCurve& out);

/// The point of the centre line nearest to p.
struct CentrePoint {
    rod::Vec2 point = rod::Vec2::Zero();
    rod::Vec2 left = rod::Vec2::UnitY(); ///< unit normal there, on the left of the tangent
    double distance = 0.0;               ///< m
    double s = 0.0;                      ///< arc length along the rod, m
};
CentrePoint nearestOnCentreLine(const ThickCurve& curve, const rod::Vec2& p);

/// All fractions in [0, 1] of the way from -> to at which it crosses the offset curves or end circles, sorted.
void crossings(const ThickCurve& curve, const rod::Vec2& from, const rod::Vec2& to, std::vector<double>& out);

/// Does the body meet the filled box?
bool meetsBox(const ThickCurve& curve, const rod::Vec2& lower, const rod::Vec2& upper);

/// The smallest upright box around the body.
void exactBox(const ThickCurve& curve, rod::Vec2& lower, rod::Vec2& upper);

} // namespace supercircle
