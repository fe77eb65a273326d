#pragma once
// Pieces of circles for the crossing witness: exact intersections and distances. On purpose written without a look at
// what detection uses.

#include "supercircle/contact/geometry.h"

#include <array>

namespace supercircle::contact::witness {

/// A piece of a circle (or a straight piece), given at its middle, turning by at most about kMaxTurn.
struct Piece {
    Vec2 mid = Vec2::Zero();
    Vec2 tangent = Vec2::UnitX(); ///< at the middle
    double curvature = 0.0;       ///< 1/m
    double half = 0.0;            ///< half its arc length, m
    Vec2 start = Vec2::Zero();    ///< the ends, at arc lengths -half and +half
    Vec2 end = Vec2::Zero();
    Vec2 apex = Vec2::Zero(); ///< where the end tangents meet: the piece lies in the triangle start, end, apex
    double cosine = 1.0;      ///< of the angle turned from the middle to an end
    double reach = 0.0;       ///< the sine of that angle over the curvature: half the chord, m

    [[nodiscard]] Vec2 at(double s) const; ///< s from the middle, m
};

constexpr double kMaxTurn = 2.0; // rad; longer arcs are cut, so that tan(turn/4) stays below 0.55

/// The piece with this middle, tangent angle there (rad), curvature and half length.
Piece makePiece(const Vec2& mid, double angle, double curvature, double half);
/// The same, given by its start and the tangent angle at its middle.
Piece makePieceFrom(const Vec2& start, double angle, double curvature, double half);

struct Meeting {
    double sA = 0.0; ///< from A's middle, m
    Vec2 where = Vec2::Zero();
};

/// Intersections of two pieces, each prolonged by `extra` at both ends; 0, 1 or 2 of them. Pieces of one and the same
/// circle that overlap meet once, in the middle of the overlap.
int intersect(const Piece& a, const Piece& b, double extra, std::array<Meeting, 2>& out);

/// Distance of two pieces, 0 when they intersect, m.
double distance(const Piece& a, const Piece& b);

/// Distance of a point from a piece, m.
double distance(const Vec2& p, const Piece& b);

/// Lower bound of the distance of two pieces from the separating directions along and across their chords, m (0 if
/// these do not separate them). Cheap: no trigonometry.
double separation(const Piece& a, const Piece& b);

} // namespace supercircle::contact::witness
