#pragma once
// Outlines prepared for detection, and the point of an outline closest to a given point.
//
// Faces are straight, with a unit normal that points out of the solid. A two-sided segment has two faces, one per side.
// Where one-sided edges of a chain join, the corner belongs to the edge that starts there, so that a point near it has
// one closest point. Only convex joined corners count; at concave ones both faces do.

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
    /// The corner is the closest point of the outline in direction w if w . c1 >= 0 and w . c2 >= 0.
    Vec2 c1 = Vec2::Zero();
    Vec2 c2 = Vec2::Zero();
    std::int32_t index = 0; ///< into Outline::points
    bool solid = false;     ///< has an inside: penetration is defined
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
    OutlineSeams seams;
};

/// Throws std::invalid_argument with the outline's key when it is malformed.
void prepare(const Outline& outline, OutlineShape& shape);

/// The closest point of an outline (without its radius).
struct OutlineHit {
    Vec2 point = Vec2::Zero();
    Vec2 normal = Vec2::Zero(); ///< unit, from the outline to the query point; out of the solid when inside
    double distance = 0.0;      ///< negative inside a solid or behind a one-sided edge, m
    std::int32_t face = -1;     ///< -1: a corner
};

/// False for a one-sided edge if another edge of its chain is nearer, or the point is deeper behind it than `depth`, m.
/// @param inward unit vector; chooses the normal for a point exactly on a two-sided segment or at a disc's centre
[[nodiscard]] bool closestOnOutline(const OutlineShape& shape, const Vec2& p, double depth, const Vec2& inward,
                                    OutlineHit& hit);

/// Cheap lower bound of the distance from p to the outline, radius included, m.
double distanceBound(const OutlineShape& shape, const Vec2& p);

/// True if the corner touches a rod whose closest point to it is `foot`. Gives the normal out of the outline and the
/// signed distance, m. Directions up to 6 degrees outside the corner's own cone are accepted, so that contacts of a rod
/// flat on a face do not flicker, and the corner does not enter the rod there.
[[nodiscard]] bool cornerHit(const Corner& corner, const Foot& foot, double depth, Vec2& normal, double& distance);

} // namespace supercircle::contact
