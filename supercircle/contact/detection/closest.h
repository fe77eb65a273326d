#pragma once
// Closest points in closed form: point to arc, arc to arc, arc to straight line. All formulas go through zero curvature
// without a switch in accuracy.
//
// In the frame of a piece's start (x along the tangent, y to the left) and with curvature k, a point (x, y) has
//
//     q = |(1 - k y, k x)|            distance to the centre of curvature, in radii
//     d = (2 y - k (x^2 + y^2)) / (1 + q)      signed distance from the arc, positive on its left
//     t = (1 - k y, k x) / q          tangent at the closest point
//     s = atan2(k x, 1 - k y) / k     its arc length
//
// (the full circle's nearest point; the sign test at the ends decides whether it lies in the piece).

#include "supercircle/contact/detection/pieces.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact {

/// A closest point on a piece.
struct Foot {
    Vec2 point = Vec2::Zero();
    Vec2 normal = Vec2::Zero(); ///< left normal of the piece there
    double distance = 0.0;      ///< signed, positive when the other point is on the left, m
    double s = 0.0;             ///< arc length along the piece, m
};

/// (P - start) . tangent at the start; positive when P is ahead.
inline double aheadOfStart(const Piece& piece, const Vec2& p) {
    return (p - piece.p0).dot(piece.t0);
}
/// (P - end) . tangent at the end; positive when P is ahead.
inline double aheadOfEnd(const Piece& piece, const Vec2& p) {
    return (p - piece.p1).dot(piece.t1);
}

/// Arc length of the closest point for a point at (x, y) in the start frame.
inline double footArc(double k, double x, double y) {
    const double c = 1.0 - k * y;
    const double a = k * x;
    if (c > 0.0 && std::abs(a) < 1e-3 * c) { // atan(u)/u; the dropped term is u^8/9 < 1e-24
        const double u = (a / c) * (a / c);
        return x / c * (1.0 - u * (1.0 / 3.0 - u * (0.2 - u / 7.0)));
    }
    return std::atan2(a, c) / k;
}

/// Foot of p on the circle of a piece, without its arc length; `x` and `y` return p in the start frame. False for the
/// centre of the circle itself.
inline bool footOnCircle(const Piece& piece, const Vec2& p, Foot& foot, double& x, double& y) {
    const Vec2 w = p - piece.p0;
    x = w.dot(piece.t0);
    y = rod::cross(piece.t0, w);
    const double k = piece.curvature;
    const double a = k * x;
    const double c = 1.0 - k * y;
    const double q = std::sqrt(a * a + c * c);
    if (q < 1e-12)
        return false;
    foot.distance = (2.0 * y - k * (x * x + y * y)) / (1.0 + q);
    // Left normal (-a, c)/q in the start frame.
    foot.normal = (c / q) * rod::perp(piece.t0) - (a / q) * piece.t0;
    return true;
}

/// Local minimum of the distance from p in the half-open interior of the piece, within maxDistance.
inline bool footInPiece(const Piece& piece, const Vec2& p, double maxDistance, Foot& foot) {
    if (!(aheadOfStart(piece, p) >= 0.0) || aheadOfEnd(piece, p) >= 0.0)
        return false;
    double x = 0.0;
    double y = 0.0;
    if (!footOnCircle(piece, p, foot, x, y) || std::abs(foot.distance) > maxDistance)
        return false;
    foot.point = p - foot.distance * foot.normal;
    foot.s = std::min(std::max(footArc(piece.curvature, x, y), 0.0), piece.length);
    return true;
}

/// An interior-interior minimum of the distance of two pieces.
struct ArcMinimum {
    Vec2 pointA = Vec2::Zero();
    Vec2 pointB = Vec2::Zero();
    Vec2 normal = Vec2::Zero(); ///< from B to A
    double distance = 0.0;      ///< m, >= 0
    double sA = 0.0;            ///< arc length along the piece of A
    double sB = 0.0;
};

/// Local minimum of the distance between two pieces, both closest points in their half-open interiors, within
/// maxDistance. It lies on the line of centres; of the four pairs of points there only nearest-nearest can be a
/// minimum. Reported only when well conditioned: with the relative curvature
///     kr = kA - kB - d kA kB   (curvatures counted positive when they bend towards +normal)
/// the two curves separate by kr l^2 / 8 within half an element from the minimum; where that is less than `depth` the
/// projected nodes see the same gap, while the place of the minimum would be arbitrary.
bool arcArcMinimum(const Piece& a, const Piece& b, double maxDistance, double depth, ArcMinimum& minimum);
/// Where to look when it is not in these pieces: -1 or +1 for the neighbour before or after, one of them not 0. Both 0:
/// the pieces have no such minimum.
struct Steps {
    int a = 0;
    int b = 0;
};
Steps stepsToMinimum(const Piece& a, const Piece& b);

/// The point of a piece where its distance from a straight line with unit normal `up` has a local minimum (signed along
/// `up`), if it is inside; under the same condition on `depth` (curvature l^2 / 8).
bool lowestPoint(const Piece& piece, const Vec2& up, double depth, Foot& foot);

/// Point and left normal at arc length s of a piece.
Foot pointOnPiece(const Piece& piece, double s);

} // namespace supercircle::contact
