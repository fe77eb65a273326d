// Take the origin at an arc's middle and axes along its tangent and normal. The circle is then  y = k (x^2 + y^2)/2 for
// every curvature k, zero included. With u = (2/k) tan(k s/2), its points are
//     x = u / D,   y = (k u^2/2) / D,   D = 1 + k^2 u^2/4.
// Inserting them into another circle's equation gives a quadratic in u, again for every pair of curvatures. Formulas
// with centres and radii lose all digits for nearly straight rods; this one loses none.

#include "supercircle/contact/circular_arc.h"

#include "supercircle/support/elementary.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact::crossing_check {

namespace {

using rod::cross;
using rod::perp;

/// atan(z)/z through z = 0.
double atanc(double z) {
    return std::abs(z) < 1e-4 ? 1.0 - z * z / 3.0 : math::atan(z) / z;
}

/// Arc length, from b's middle, of the point of b's circle nearest to p. p is any point but the circle's centre.
double nearestOnCircle(const Vec2& p, const CircularArc& b) {
    const Vec2 q = p - b.mid;
    const double x = q.dot(b.tangent);
    const double c = 1.0 - b.curvature * cross(b.tangent, q);
    if (c > 0.0)
        return x / c * atanc(b.curvature * x / c);
    return math::atan2(b.curvature * x, c) / b.curvature; // beyond the centre, so the curvature is not 0
}

void addIfOn(const CircularArc& a, const CircularArc& b, double u, double extra, int& count,
             std::array<Intersection, 2>& out) {
    // |s| >= |u| / 1.1 while the angle is below 1.1 rad: distant points need no arc tangent.
    if (std::abs(u) > 1.1 * (a.half + extra) && std::abs(a.curvature) * (a.half + extra) < 1.0)
        return;
    const double s = u * atanc(0.5 * a.curvature * u);
    if (!(std::abs(s) <= a.half + extra))
        return;
    const Vec2 p = a.at(s);
    if (!(std::abs(nearestOnCircle(p, b)) <= b.half + extra))
        return;
    out[static_cast<std::size_t>(count)] = {s, p};
    ++count;
}

/// Arcs of one circle: the middle of their common part.
int overlap(const CircularArc& a, const CircularArc& b, double extra, std::array<Intersection, 2>& out) {
    double s0 = nearestOnCircle(b.start, a);
    double s1 = nearestOnCircle(b.end, a);
    if (s0 > s1)
        std::swap(s0, s1);
    const double low = std::max(s0 - extra, -a.half - extra);
    const double high = std::min(s1 + extra, a.half + extra);
    if (low > high)
        return 0;
    const double s = 0.5 * (low + high);
    out[0] = {s, a.at(s)};
    return 1;
}

/// Interior pair of points with a common normal. Its direction is that of the line of centres, written so that it stays
/// finite for straight arcs. The points with that normal are searched on the more curved arc.
double commonNormalDistance(const CircularArc& a, const CircularArc& b) {
    const bool swap = std::abs(a.curvature) < std::abs(b.curvature);
    const CircularArc& p = swap ? b : a;
    const CircularArc& q = swap ? a : b;
    if (p.curvature == 0.0)
        return INFINITY; // two straight arcs: an end is as near as any point
    const Vec2 direction =
        p.curvature * q.curvature * (q.mid - p.mid) + p.curvature * perp(q.tangent) - q.curvature * perp(p.tangent);
    double best = INFINITY;
    // Sine and cosine (times the length) of the angle from p's middle normal to this one.
    const double sine = direction.dot(-p.tangent);
    const double cosine = direction.dot(perp(p.tangent));
    if (std::abs(cosine) < 0.999 * p.cosine * direction.norm())
        return best; // outside the arc in both directions
    for (const double sign : {1.0, -1.0}) {
        const double s = math::atan2(sign * sine, sign * cosine) / p.curvature;
        if (std::abs(s) <= p.half)
            best = std::min(best, distance(p.at(s), q));
    }
    return best;
}

} // namespace

Vec2 CircularArc::at(double s) const {
    const double x = 0.5 * curvature * s;
    const double c = s * math::sinc(x);
    const math::SinCos a = math::sinCosSmall(x);
    const Vec2 along(c * a.cosine, c * a.sine);
    return mid + along.x() * tangent + along.y() * perp(tangent);
}

namespace {

/// Everything but the middle, relative to a middle at the origin.
CircularArc aroundOrigin(double angle, double curvature, double half) {
    CircularArc p;
    const math::SinCos turned = math::sinCos(angle);
    p.tangent = {turned.cosine, turned.sine};
    p.curvature = curvature;
    p.half = half;
    // Ends at (+-along, across): half sin(2x)/(2x) and half (1 - cos 2x)/(2x), x a quarter of the turn.
    const double x = 0.5 * curvature * half;
    const double sinc = math::sinc(x);
    const double sine = x * sinc;
    p.cosine = 1.0 - 2.0 * sine * sine;
    p.reach = half * sinc * std::sqrt(1.0 - sine * sine);
    const Vec2 along = p.reach * p.tangent;
    const Vec2 across = half * sinc * sine * perp(p.tangent);
    p.start = across - along;
    p.end = across + along;
    p.apex = across / -p.cosine; // (1 - 1/cos 2x)/k on the middle normal
    return p;
}

CircularArc& shift(CircularArc& p, const Vec2& by) {
    p.mid += by;
    p.start += by;
    p.end += by;
    p.apex += by;
    return p;
}

} // namespace

CircularArc makeArc(const Vec2& mid, double angle, double curvature, double half) {
    SC_ASSERT_EXPENSIVE(!(half < 0.0), "a length is not negative");
    CircularArc p = aroundOrigin(angle, curvature, half);
    return shift(p, mid);
}

CircularArc makeArcFromStart(const Vec2& start, double angle, double curvature, double half) {
    CircularArc p = aroundOrigin(angle, curvature, half);
    return shift(p, start - p.start);
}

int intersect(const CircularArc& a, const CircularArc& b, double extra, std::array<Intersection, 2>& out) {
    // b's equation F(p) = q.n - (k/2) q^2 with q = p - b.mid, at a's middle, and its gradient w there
    const Vec2 q = a.mid - b.mid;
    const Vec2 n = perp(b.tangent);
    const double f = q.dot(n) - 0.5 * b.curvature * q.squaredNorm();
    const Vec2 w = n - b.curvature * q;
    const double k = a.curvature;
    const double c2 = 0.25 * f * k * k + 0.5 * k * w.dot(perp(a.tangent)) - 0.5 * b.curvature;
    const double c1 = w.dot(a.tangent);
    // Same circle: every coefficient is round-off.
    const double reach = a.half + b.half + std::sqrt(q.squaredNorm());
    if (std::abs(f) < 1e-12 * reach && std::abs(c1) < 1e-12 && std::abs(c2) * reach < 1e-12)
        return overlap(a, b, extra, out);
    const double discriminant = c1 * c1 - 4.0 * c2 * f;
    if (!(discriminant >= 0.0))
        return 0;
    int count = 0;
    const double root = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1)); // no cancellation
    if (root != 0.0)
        addIfOn(a, b, f / root, extra, count, out);
    if (c2 != 0.0 && (discriminant > 0.0 || root == 0.0))
        addIfOn(a, b, root / c2, extra, count, out);
    SC_ASSERT_EXPENSIVE(count <= 2, "two circles have two points in common at most");
    return count;
}

double distance(const Vec2& p, const CircularArc& b) {
    // The nearest point of the circle is at the angle of (c, k x); beyond an end if the sine of the angle between is
    // positive.
    const Vec2 q = p - b.mid;
    const double x = q.dot(b.tangent);
    const double y = cross(b.tangent, q);
    const double c = 1.0 - b.curvature * y;
    if (std::abs(x) * b.cosine > c * b.reach)
        return (p - (x > 0.0 ? b.end : b.start)).norm();
    // |q| of a circle's point at radial distance: |1 - k y, k x| = k r; without dividing by k near zero.
    const double f = y - 0.5 * b.curvature * q.squaredNorm();
    const double ratio = std::sqrt(std::max(0.0, 1.0 - 2.0 * b.curvature * f)); // distance from the centre over radius
    return 2.0 * std::abs(f) / (1.0 + ratio);
}

double distance(const CircularArc& a, const CircularArc& b) {
    std::array<Intersection, 2> intersections;
    if (intersect(a, b, 0.0, intersections) > 0)
        return 0.0;
    double best = commonNormalDistance(a, b);
    for (const Vec2& p : {a.start, a.end})
        best = std::min(best, distance(p, b));
    for (const Vec2& p : {b.start, b.end})
        best = std::min(best, distance(p, a));
    return best;
}

double separation(const CircularArc& a, const CircularArc& b) {
    double best = 0.0;
    for (const Vec2& axis : {a.tangent, perp(a.tangent), b.tangent, perp(b.tangent)}) {
        const auto [aLow, aHigh] = std::minmax({axis.dot(a.start), axis.dot(a.end), axis.dot(a.apex)});
        const auto [bLow, bHigh] = std::minmax({axis.dot(b.start), axis.dot(b.end), axis.dot(b.apex)});
        best = std::max({best, aLow - bHigh, bLow - aHigh});
    }
    return best;
}

} // namespace supercircle::contact::crossing_check
