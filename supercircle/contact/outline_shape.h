#pragma once
// Outlines prepared for detection, and the point of an outline closest to a given point.
//
// Faces are straight, with a unit normal that points out of the solid; a two-sided segment has two, one for each side.
// Corners are owned: where one-sided edges of a chain join, the edge that starts there owns the corner, so that a point
// or a rod near it is answered once. Only convex joined corners count; at concave ones both faces answer.

#include "supercircle/contact/detection/closest.h"

#include <vector>

namespace supercircle::contact {

struct Face {
    Vec2 start = Vec2::Zero();
    Vec2 along = Vec2::Zero();  ///< unit vector
    Vec2 normal = Vec2::Zero(); ///< unit, out of the solid
    double length = 0.0;        ///< m
};

struct Corner {
    Vec2 p = Vec2::Zero();
    /// A direction w belongs to the corner (no other point of the outline is closer that way) when w . c1 >= 0 and
    /// w . c2 >= 0.
    Vec2 c1 = Vec2::Zero();
    Vec2 c2 = Vec2::Zero();
    std::int32_t index = 0; ///< into Outline::points
    bool solid = false;     ///< has an inside: penetration can be told
};

struct OutlineShape {
    OutlineKind kind = OutlineKind::Segment;
    std::vector<Face> faces;
    std::vector<Corner> corners;
    Vec2 centre = Vec2::Zero();
    double radius = 0.0;
    bool joinedStart = false;
    bool joinedEnd = false;
    bool convexStart = false;
    bool convexEnd = false;
    Face before; ///< the neighbouring edges where joined
    Face after;
};

/// Throws std::invalid_argument with the outline's key when it is malformed.
void prepare(const Outline& outline, OutlineShape& shape);

/// The closest point of an outline (without its radius).
struct OutlineHit {
    Vec2 point = Vec2::Zero();
    Vec2 normal = Vec2::Zero(); ///< unit, from the outline to the point asked about; out of the solid when inside
    double distance = 0.0;      ///< negative inside a solid or behind a one-sided edge, m
    std::int32_t face = -1;     ///< -1: a corner
};

/// False where a one-sided edge does not answer: another edge of its chain is nearer, or the point is more than
/// `depth` behind it. `inward` breaks the tie for a point exactly on a two-sided segment or at a disc's centre: a unit
/// vector, the normal is the one along it.
bool closestOnOutline(const OutlineShape& shape, const Vec2& p, double depth, const Vec2& inward, OutlineHit& hit);

/// A number not above the distance from p to the outline, radius included; cheap.
double distanceBound(const OutlineShape& shape, const Vec2& p);

/// Does the corner answer for a rod whose closest point to it is p (left normal of the rod there: `foot`)? Gives the
/// normal out of the outline and the signed distance. Directions up to 6 degrees outside the corner's own are accepted,
/// so that a rod lying flat on a face does not flicker; the corner must not enter the rod there either.
bool cornerHit(const Corner& corner, const Foot& foot, double depth, Vec2& normal, double& distance);

} // namespace supercircle::contact
