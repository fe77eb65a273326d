#include "supercircle/contact/detection/closest.h"

#include "supercircle/support/elementary.h"
#include "supercircle/support/invariants.h"

namespace supercircle::contact {

namespace {

/// An element whose tangent rotates by less than this (rad) counts as straight in the search for minima.
constexpr double kStraight = 1e-7;

} // namespace

bool arcArcMinimum(const SubArc& a, const SubArc& b, double maxDistance, double depth, ArcMinimum& minimum) {
    // The more curved sub-arc has the more accurate centre. Its foot on the other one is accurate even if that is
    // straight.
    const bool roundIsA = std::abs(a.curvature) > std::abs(b.curvature);
    const SubArc& round = roundIsA ? a : b;
    const SubArc& flat = roundIsA ? b : a;
    const double l = std::min(a.span, b.span);
    if (std::abs(round.curvature) * l < kStraight)
        return false;
    const Vec2 centre = round.p0 + rod::perp(round.t0) / round.curvature;
    if (!(aheadOfStart(flat, centre) >= 0.0) || aheadOfEnd(flat, centre) >= 0.0)
        return false;
    Foot onFlat;
    double x = 0.0;
    double y = 0.0;
    if (!footOnCircle(flat, centre, onFlat, x, y))
        return false;
    if (std::abs(std::abs(onFlat.distance) - 1.0 / std::abs(round.curvature)) > maxDistance)
        return false;
    onFlat.point = centre - onFlat.distance * onFlat.normal;
    Foot onRound;
    if (!footInSubArc(round, onFlat.point, maxDistance, onRound))
        return false;

    // Frame from round to flat; curvatures are positive when they bend towards it.
    const double side = onRound.distance >= 0.0 ? 1.0 : -1.0;
    const Vec2 normal = side * onRound.normal;
    const double distance = std::abs(onRound.distance);
    const double kRound = round.curvature * side;
    const double kFlat = normal.dot(onFlat.normal) >= 0.0 ? flat.curvature : -flat.curvature;
    const double relative = kFlat - kRound - distance * kFlat * kRound;
    if (!(relative * l * l / 8.0 >= depth) || !(relative * l >= kStraight) || 1.0 + distance * kFlat <= 0.0)
        return false;

    const double sFlat = std::min(std::max(footArc(flat.curvature, x, y), 0.0), flat.length);
    minimum.distance = distance;
    minimum.normal = roundIsA ? Vec2(-normal) : normal;
    minimum.pointA = roundIsA ? onRound.point : onFlat.point;
    minimum.pointB = roundIsA ? onFlat.point : onRound.point;
    minimum.sA = roundIsA ? onRound.s : sFlat;
    minimum.sB = roundIsA ? sFlat : onRound.s;
    return true;
}

NeighbourSteps stepsToMinimum(const SubArc& a, const SubArc& b) {
    const bool roundIsA = std::abs(a.curvature) > std::abs(b.curvature);
    const SubArc& round = roundIsA ? a : b;
    const SubArc& flat = roundIsA ? b : a;
    NeighbourSteps steps;
    if (std::abs(round.curvature) * std::min(a.span, b.span) < kStraight)
        return steps;
    const auto step = [](const SubArc& arc, const Vec2& p) {
        return aheadOfStart(arc, p) < 0.0 ? -1 : (aheadOfEnd(arc, p) >= 0.0 ? 1 : 0);
    };
    const Vec2 centre = round.p0 + rod::perp(round.t0) / round.curvature;
    int& onFlat = roundIsA ? steps.b : steps.a;
    int& onRound = roundIsA ? steps.a : steps.b;
    Foot foot;
    double x = 0.0;
    double y = 0.0;
    onFlat = step(flat, centre);
    if (onFlat != 0 || !footOnCircle(flat, centre, foot, x, y))
        return steps;
    onRound = step(round, centre - foot.distance * foot.normal);
    return steps;
}

bool lowestPoint(const SubArc& arc, const Vec2& up, double depth, Foot& foot) {
    const double g0 = arc.t0.dot(up);
    if (!(g0 < 0.0) || !(arc.t1.dot(up) >= 0.0))
        return false;
    const double k = std::abs(arc.curvature);
    if (k * arc.span * arc.span / 8.0 < depth || k * arc.span < kStraight)
        return false;
    // t(phi) . up = g0 cos phi + (n0 . up) sin phi = 0 with phi of the sign of the curvature.
    const double c = rod::perp(arc.t0).dot(up) * (arc.curvature > 0.0 ? 1.0 : -1.0);
    foot = pointOnSubArc(arc, std::min(std::max(math::atan2(-g0, c) / k, 0.0), arc.length));
    return true;
}

Foot pointOnSubArc(const SubArc& arc, double s) {
    SC_ASSERT_EXPENSIVE(!(s < 0.0) && !(s > arc.length), "a point of the sub-arc");
    const double half = 0.5 * arc.curvature * s;
    const math::SinCos turned = math::sinCosSmall(half);
    const double c = turned.cosine;
    const double e = turned.sine;
    const Vec2 n0 = rod::perp(arc.t0);
    const Vec2 middle = c * arc.t0 + e * n0;
    Foot foot;
    foot.point = arc.p0 + s * math::sinc(half) * middle;
    foot.normal = c * rod::perp(middle) - e * middle;
    foot.s = s;
    return foot;
}

} // namespace supercircle::contact
