#include "supercircle/contact/detection/closest.h"

namespace supercircle::contact {

namespace {

/// Bends less than this over an element: straight for the purpose of minima (no centre worth the name).
constexpr double kStraight = 1e-7;

} // namespace

bool arcArcMinimum(const Piece& a, const Piece& b, double maxDistance, double depth, ArcMinimum& minimum) {
    // The rounder piece has the better centre; its foot on the flatter one is accurate even when that one is straight.
    const bool roundIsA = std::abs(a.curvature) > std::abs(b.curvature);
    const Piece& round = roundIsA ? a : b;
    const Piece& flat = roundIsA ? b : a;
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
    if (!footInPiece(round, onFlat.point, maxDistance, onRound))
        return false;

    // Frame from round to flat; curvatures positive when they bend towards it.
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

Steps stepsToMinimum(const Piece& a, const Piece& b) {
    const bool roundIsA = std::abs(a.curvature) > std::abs(b.curvature);
    const Piece& round = roundIsA ? a : b;
    const Piece& flat = roundIsA ? b : a;
    Steps steps;
    if (std::abs(round.curvature) * std::min(a.span, b.span) < kStraight)
        return steps;
    const auto step = [](const Piece& piece, const Vec2& p) {
        return aheadOfStart(piece, p) < 0.0 ? -1 : (aheadOfEnd(piece, p) >= 0.0 ? 1 : 0);
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

bool lowestPoint(const Piece& piece, const Vec2& up, double depth, Foot& foot) {
    const double g0 = piece.t0.dot(up);
    if (!(g0 < 0.0) || !(piece.t1.dot(up) >= 0.0))
        return false;
    const double k = std::abs(piece.curvature);
    if (k * piece.span * piece.span / 8.0 < depth || k * piece.span < kStraight)
        return false;
    // t(phi) . up = g0 cos phi + (n0 . up) sin phi = 0 with phi of the sign of the curvature.
    const double c = rod::perp(piece.t0).dot(up) * (piece.curvature > 0.0 ? 1.0 : -1.0);
    foot = pointOnPiece(piece, std::min(std::max(std::atan2(-g0, c) / k, 0.0), piece.length));
    return true;
}

Foot pointOnPiece(const Piece& piece, double s) {
    const double half = 0.5 * piece.curvature * s;
    const rod::SinCos turned = rod::sinCosSmall(half);
    const double c = turned.cosine;
    const double e = turned.sine;
    const Vec2 n0 = rod::perp(piece.t0);
    const Vec2 middle = c * piece.t0 + e * n0;
    Foot foot;
    foot.point = piece.p0 + s * rod::sinc(half) * middle;
    foot.normal = c * rod::perp(middle) - e * middle;
    foot.s = s;
    return foot;
}

} // namespace supercircle::contact
