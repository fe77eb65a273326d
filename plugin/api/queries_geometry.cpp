#include "plugin/api/queries_geometry.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle {

using contact::crossing_check::CircularArc;
using contact::crossing_check::makeArc;
using rod::cross;
using rod::perp;
using rod::Vec2;

void thicken(const step::Rod& rod, ThickCurve& out) {
    out.pieces.clear();
    out.middleS.clear();
    out.half = 0.5 * rod.model.definition().thickness;
    out.length = rod.model.definition().length;
    out.lower.setConstant(INFINITY);
    out.upper.setConstant(-INFINITY);
    const std::vector<rod::Arc>& arcs = rod.kin.arcs();
    for (std::size_t i = 0; i < arcs.size(); ++i) {
        const rod::Arc& a = arcs[i];
        // Bounded: an effect may curve an element without limit, and queries must still return.
        const double turns = std::abs(a.curvature) * a.length / contact::crossing_check::kMaxTurn;
        const int parts = 1 + static_cast<int>(std::min(turns, 256.0));
        for (int k = 0; k < parts; ++k) {
            const double s = a.length * (k + 0.5) / parts;
            out.pieces.push_back(makeArc(a.pointAt(s), a.angleAt(s), a.curvature, 0.5 * a.length / parts));
            out.middleS.push_back(rod.model.nodeS(static_cast<int>(i)) + s);
            const CircularArc& p = out.pieces.back();
            for (const Vec2& corner : {p.start, p.end, p.apex}) {
                out.lower = out.lower.cwiseMin(corner);
                out.upper = out.upper.cwiseMax(corner);
            }
        }
    }
    out.lower -= Vec2::Constant(out.half);
    out.upper += Vec2::Constant(out.half);
    out.first = rod.kin.node(0);
    out.last = rod.kin.node(rod.model.elements());
}

namespace {

/// Arc length, from the middle of a piece, of its point closest to p.
double closestArcLength(const CircularArc& b, const Vec2& p) {
    const Vec2 q = p - b.mid;
    const double x = q.dot(b.tangent);
    const double c = 1.0 - b.curvature * cross(b.tangent, q);
    if (std::abs(x) * b.cosine > c * b.reach) // beyond an end
        return x > 0.0 ? b.half : -b.half;
    if (c <= 0.0)
        return 0.0; // the centre of curvature: all points have the same distance
    const double z = b.curvature * x / c;
    const double s = std::abs(z) < 1e-4 ? x / c * (1.0 - z * z / 3.0) : math::atan(z) / b.curvature;
    return std::clamp(s, -b.half, b.half);
}

/// Curve at distance d to the left of a piece; false where the offset exceeds the radius.
bool offset(const CircularArc& p, double d, CircularArc& out) {
    const double stretch = 1.0 - p.curvature * d;
    if (stretch <= 1e-9)
        return false;
    out = p;
    out.mid = p.mid + d * perp(p.tangent);
    out.curvature = p.curvature / stretch;
    out.half = p.half * stretch;
    const auto shift = [&](double s, Vec2& end) {
        const double angle = p.curvature * s; // of the tangent, from the middle one
        const Vec2 normal = math::cos(angle) * perp(p.tangent) - math::sin(angle) * p.tangent;
        end += d * normal;
    };
    shift(-p.half, out.start);
    shift(p.half, out.end);
    return true;
}

void intersectCircle(const Vec2& centre, double radius, const Vec2& from, const Vec2& ray, std::vector<double>& out) {
    const Vec2 q = from - centre;
    const double a = ray.squaredNorm(), b = q.dot(ray);
    const double height = cross(ray, q) * cross(ray, q) / a; // squared distance of the line from the centre
    const double rest = radius * radius - height;
    if (rest < 0.0)
        return;
    const double root = std::sqrt(rest / a);
    for (const double t : {-b / a - root, -b / a + root})
        if (t >= 0.0 && t <= 1.0)
            out.push_back(t);
}

} // namespace

CentrePoint closestOnCentreLine(const ThickCurve& curve, const Vec2& p) {
    double best = INFINITY;
    std::size_t at = 0;
    for (std::size_t i = 0; i < curve.pieces.size(); ++i) {
        const double d = contact::crossing_check::distance(p, curve.pieces[i]);
        if (d < best) {
            best = d;
            at = i;
        }
    }
    CentrePoint out;
    if (curve.pieces.empty())
        return out;
    const CircularArc& piece = curve.pieces[at];
    const double s = closestArcLength(piece, p);
    const double angle = piece.curvature * s;
    out.point = piece.at(s);
    out.left = math::cos(angle) * perp(piece.tangent) - math::sin(angle) * piece.tangent;
    out.distance = best;
    out.s = std::clamp(curve.middleS[at] + s, 0.0, curve.length);
    return out;
}

void intersections(const ThickCurve& curve, const Vec2& from, const Vec2& to, std::vector<double>& out) {
    out.clear();
    const Vec2 way = to - from;
    const double length = way.norm();
    CircularArc ray;
    ray.mid = 0.5 * (from + to);
    ray.tangent = way / length;
    ray.half = 0.5 * length;
    ray.start = from;
    ray.end = to;
    ray.apex = ray.mid;
    ray.reach = ray.half;
    std::array<contact::crossing_check::Intersection, 2> meetings;
    CircularArc side;
    for (const CircularArc& p : curve.pieces) {
        const double reach = p.half + curve.half; // a circle about the piece
        if (std::abs(cross(ray.tangent, p.mid - ray.mid)) > reach)
            continue;
        for (const double d : {curve.half, -curve.half}) {
            if (!offset(p, d, side))
                continue;
            const int n = contact::crossing_check::intersect(ray, side, 1e-12 * (length + curve.length), meetings);
            for (int i = 0; i < n; ++i) {
                const double t = 0.5 + meetings[static_cast<std::size_t>(i)].sA / length;
                out.push_back(std::clamp(t, 0.0, 1.0));
            }
        }
    }
    intersectCircle(curve.first, curve.half, from, way, out);
    intersectCircle(curve.last, curve.half, from, way, out);
    std::sort(out.begin(), out.end());
}

bool overlapsBox(const ThickCurve& curve, const Vec2& lower, const Vec2& upper) {
    if ((curve.lower.array() > upper.array()).any() || (lower.array() > curve.upper.array()).any())
        return false;
    const Vec2 corners[4] = {lower, {upper.x(), lower.y()}, upper, {lower.x(), upper.y()}};
    for (const CircularArc& p : curve.pieces) {
        if ((p.start.array() >= lower.array()).all() && (p.start.array() <= upper.array()).all())
            return true;
        for (int i = 0; i < 4; ++i) {
            const Vec2 a = corners[i], edge = corners[(i + 1) % 4] - a;
            const double length = edge.norm();
            const double d = length > 0.0
                                 ? contact::crossing_check::distance(
                                       p, makeArc(a + 0.5 * edge, math::atan2(edge.y(), edge.x()), 0.0, 0.5 * length))
                                 : contact::crossing_check::distance(a, p);
            if (d <= curve.half)
                return true;
        }
    }
    return false;
}

void boundingBox(const ThickCurve& curve, Vec2& lower, Vec2& upper) {
    lower.setConstant(INFINITY);
    upper.setConstant(-INFINITY);
    const auto include = [&](const Vec2& p) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    };
    for (const CircularArc& p : curve.pieces) {
        include(p.start);
        include(p.end);
        if (p.curvature == 0.0)
            continue;
        for (const Vec2& axis : {Vec2::UnitX().eval(), Vec2::UnitY().eval()}) { // where the tangent is along an axis
            const double angle = math::atan2(cross(p.tangent, axis), p.tangent.dot(axis));
            for (const double turned : {angle, angle - std::copysign(M_PI, angle)}) {
                const double s = turned / p.curvature;
                if (std::abs(s) < p.half)
                    include(p.at(s));
            }
        }
    }
    lower -= Vec2::Constant(curve.half);
    upper += Vec2::Constant(curve.half);
}

} // namespace supercircle
