#include "supercircle/contact/one_sided.h"

#include "supercircle/contact/circular_arc.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact {

namespace {

bool isLeft(const Vec2& a, const Vec2& b, const Vec2& p) {
    return rod::cross(b - a, p - a) >= 0.0;
}

double squareToSegment(const Vec2& a, const Vec2& b, const Vec2& p) {
    const Vec2 edge = b - a;
    const double square = edge.squaredNorm();
    const double x = square > 0.0 ? std::clamp((p - a).dot(edge) / square, 0.0, 1.0) : 0.0;
    return (p - a - x * edge).squaredNorm();
}

} // namespace

bool isInFront(const Vec2& p, const Outline& edge) {
    const Vec2 &a = edge.points[0], &b = edge.points[1];
    const double own = (1.0 + 1e-12) * squareToSegment(a, b, p);
    bool front = isLeft(a, b, p);
    const auto ask = [&](const Vec2& c, const Vec2& d, const Vec2& far, bool ridge) {
        if (squareToSegment(c, d, p) <= own && (p - far).dot(c + d - 2.0 * far) >= 0.0)
            front = ridge ? front || isLeft(c, d, p) : front && isLeft(c, d, p);
    };
    const Vec2 &before = edge.neighbourStart, &after = edge.neighbourEnd;
    if (edge.joinedStart)
        ask(before, a, before, !isLeft(before, a, b));
    if (edge.joinedEnd)
        ask(b, after, after, !isLeft(a, b, after));
    return front;
}

bool reaches(const RodCurve& curve, const Outline& edge, double distance) {
    const Vec2 way = edge.points[1] - edge.points[0], middle = edge.points[0] + 0.5 * way;
    const crossing_check::CircularArc segment =
        crossing_check::makeArc(middle, math::atan2(way.y(), way.x()), 0.0, 0.5 * way.norm());
    const auto arcReaches = [&](const Arc& arc) {
        const double far = arc.length + distance;
        if (squareToSegment(edge.points[0], edge.points[1], arc.start) > far * far)
            return false;
        const int parts =
            std::max(1, static_cast<int>(std::ceil(std::abs(arc.curvature) * arc.length / crossing_check::kMaxTurn)));
        const double length = arc.length / parts;
        for (int i = 0; i < parts; ++i) {
            const double s = (i + 0.5) * length;
            const auto part = crossing_check::makeArc(arc.pointAt(s), arc.angleAt(s), arc.curvature, 0.5 * length);
            if (crossing_check::distance(part, segment) <= distance)
                return true;
        }
        return false;
    };
    return std::any_of(curve.arcs.begin(), curve.arcs.end(), arcReaches);
}

} // namespace supercircle::contact
