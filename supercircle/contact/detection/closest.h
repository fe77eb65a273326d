#pragma once
// Closest points in closed form: point to arc, arc to arc, arc to straight line. All formulas are accurate through zero
// curvature without a switch.
//
// In the frame of a sub-arc's start (x along the tangent, y to the left) and with curvature k, a point (x, y) has
//     q = |(1 - k y, k x)|                     distance to the centre of curvature, in radii
//     d = (2 y - k (x^2 + y^2)) / (1 + q)      signed distance from the arc, positive on its left
//     t = (1 - k y, k x) / q                   tangent at the closest point
//     s = atan2(k x, 1 - k y) / k              its arc length
// This is the nearest point of the full circle; sign tests at the ends decide whether it lies on the sub-arc.

#include "supercircle/contact/detection/sub_arcs.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact {

/// A closest point on a sub-arc.
struct Foot {
    Vec2 point = Vec2::Zero();
    Vec2 normal = Vec2::Zero(); ///< left normal of the sub-arc there
    double distance = 0.0;      ///< signed, positive when the other point is on the left, m
    double s = 0.0;             ///< arc length along the sub-arc, m
};

/// (P - start) . tangent at the start, m; positive when P is ahead.
inline double aheadOfStart(const SubArc& arc, const Vec2& p) {
    return (p - arc.p0).dot(arc.t0);
}
/// (P - end) . tangent at the end, m; positive when P is ahead.
inline double aheadOfEnd(const SubArc& arc, const Vec2& p) {
    return (p - arc.p1).dot(arc.t1);
}

/// Arc length of the closest point for a point at (x, y) in the start frame.
inline double footArc(double k, double x, double y) {
    const double c = 1.0 - k * y;
    const double a = k * x;
    if (c > 0.0 && std::abs(a) < 1e-3 * c) { // atan(u)/u; the dropped term is u^8/9 < 1e-24
        const double u = (a / c) * (a / c);
        return x / c * (1.0 - u * (1.0 / 3.0 - u * (0.2 - u / 7.0)));
    }
    return math::atan2(a, c) / k;
}

/// Foot of p on the circle of a sub-arc, without its arc length. `x` and `y` return p in the start frame. False for the
/// centre of the circle.
[[nodiscard]] inline bool footOnCircle(const SubArc& arc, const Vec2& p, Foot& foot, double& x, double& y) {
    const Vec2 w = p - arc.p0;
    x = w.dot(arc.t0);
    y = rod::cross(arc.t0, w);
    const double k = arc.curvature;
    const double a = k * x;
    const double c = 1.0 - k * y;
    const double q = std::sqrt(a * a + c * c);
    if (q < 1e-12)
        return false;
    foot.distance = (2.0 * y - k * (x * x + y * y)) / (1.0 + q);
    // Left normal (-a, c)/q in the start frame.
    foot.normal = (c / q) * rod::perp(arc.t0) - (a / q) * arc.t0;
    return true;
}

/// Local minimum of the distance from p in the half-open interior of the sub-arc, within maxDistance (m).
[[nodiscard]] inline bool footInSubArc(const SubArc& arc, const Vec2& p, double maxDistance, Foot& foot) {
    if (!(aheadOfStart(arc, p) >= 0.0) || aheadOfEnd(arc, p) >= 0.0)
        return false;
    double x = 0.0;
    double y = 0.0;
    if (!footOnCircle(arc, p, foot, x, y) || std::abs(foot.distance) > maxDistance)
        return false;
    foot.point = p - foot.distance * foot.normal;
    foot.s = std::min(std::max(footArc(arc.curvature, x, y), 0.0), arc.length);
    return true;
}

/// An interior-interior minimum of the distance of two sub-arcs.
struct ArcMinimum {
    Vec2 pointA = Vec2::Zero();
    Vec2 pointB = Vec2::Zero();
    Vec2 normal = Vec2::Zero(); ///< from B to A
    double distance = 0.0;      ///< m, >= 0
    double sA = 0.0;            ///< arc length along the sub-arc of A, m
    double sB = 0.0;
};

/// Local minimum of the distance between two sub-arcs, both closest points in their half-open interiors, within
/// maxDistance (m). It lies on the line of centres. Of the four pairs of points there, only nearest-nearest can be a
/// minimum. It is reported only when well conditioned. With the relative curvature
///     kr = kA - kB - d kA kB   (curvatures counted positive when they bend towards +normal)
/// the two curves separate by kr l^2 / 8 within half an element from the minimum. Where that is less than `depth` (m),
/// the projected nodes give the same gap, and the position of the minimum would be arbitrary.
[[nodiscard]] bool arcArcMinimum(const SubArc& a, const SubArc& b, double maxDistance, double depth,
                                 ArcMinimum& minimum);
/// Where to search if the minimum is not on these sub-arcs: -1 or +1 for the neighbour before or after. Both 0: there
/// is no such minimum.
struct NeighbourSteps {
    int a = 0;
    int b = 0;
};
NeighbourSteps stepsToMinimum(const SubArc& a, const SubArc& b);

/// The interior point of a sub-arc whose distance from a straight line with unit normal `up` has a local minimum
/// (signed along `up`), under the same condition on `depth` (curvature l^2 / 8).
[[nodiscard]] bool lowestPoint(const SubArc& arc, const Vec2& up, double depth, Foot& foot);

/// Point and left normal at arc length s (m) of a sub-arc.
Foot pointOnSubArc(const SubArc& arc, double s);

} // namespace supercircle::contact
