// Held points stop where their surface meets a body that cannot yield: holds are eliminated from the step's equations,
// so that contact could neither push them back nor keep them out. Before the first step of a frame the way of each held
// point is followed against the outlines of static and kinematic bodies as these move (conservative advancement: with
// the gap g and the relative speed c nothing meets before g / c).

#include "supercircle/contact/filter.h"
#include "supercircle/step/applied_forces.h"
#include "supercircle/step/contacts/one_sided.h"
#include "supercircle/step/contacts/pair_vetoes.h"
#include "supercircle/step/stages/hold_pairs.h"
#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Of the shell's thickness:
// A stopped point rests out of the body by this. Halved or doubled, it is far from both kTouch and rounding.
constexpr double kRest = 0.001;
// Deeper is driven in. Halved, points that slide along a wall on a rounded way stop; doubled, steps are rejected for
// penetration before the stop (Settings::rejectPenetration is 0.02).
constexpr double kTouch = 0.01;
// Points that begin a frame deeper than this are in the body already: nothing is left to stop. As rejectPenetration.
constexpr double kInside = 0.02;
// A way that is in the body for a part of the frame only is a point that follows a turning body: not stopped up to this
// depth. Halved, holds on platforms stop at twice the frames a second; doubled, a centre line comes to the surface.
// Ways are followed in parts of this length at least.
constexpr double kShallow = 0.25;
// The body is left behind from this gap on, as a contact ends (events.hpp). Doubled or halved: bounces count more or
// less often.
constexpr double kLeft = 0.05;

double toSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
    const Vec2 edge = b - a;
    const double square = edge.squaredNorm();
    const double x = square > 0.0 ? std::clamp((p - a).dot(edge) / square, 0.0, 1.0) : 0.0;
    return (p - a - x * edge).norm();
}

/// Signed distance from a line of an outline, positive on its left, m.
double leftOf(const Vec2& p, const Vec2& a, const Vec2& b) {
    return rod::cross(b - a, p - a) / std::max((b - a).norm(), 1e-300);
}

/// Distance of a point from an outline without its radius, negative inside a solid or behind a one-sided edge, m. All
/// in the body's frame. The ends of one-sided edges count for points in front of them.
double distance(const Vec2& p, const contact::Outline& o) {
    const contact::OutlinePoints& x = o.points;
    switch (o.kind) {
    case contact::OutlineKind::Circle:
        return (p - x[0]).norm();
    case contact::OutlineKind::Segment:
        return toSegment(p, x[0], x[1]);
    case contact::OutlineKind::OneSided: {
        const double side = leftOf(p, x[0], x[1]);
        if (side >= 0.0)
            return toSegment(p, x[0], x[1]);
        const double along = (p - x[0]).dot(x[1] - x[0]);
        return along < 0.0 || along > (x[1] - x[0]).squaredNorm() ? kInfinity : side;
    }
    case contact::OutlineKind::Polygon:
        break;
    }
    double inside = kInfinity, outside = kInfinity;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec2 &a = x[i], &b = x[(i + 1) % x.size()];
        inside = std::min(inside, leftOf(p, a, b));
        outside = std::min(outside, toSegment(p, a, b));
    }
    return inside >= 0.0 ? -inside : outside;
}

bool filtered(const World& world, const Rod& rod, const BodyOutline& piece) {
    const contact::Outline& o = piece.local;
    if (vetoed(world, rod, piece) ||
        !contact::mayTouch({rod.category, rod.mask, rod.group}, {o.category, o.mask, o.group}))
        return true;
    return std::any_of(world.links.begin(), world.links.end(), [&](const Link& l) {
        return !l.collide && l.end == LinkEnd::Body && l.body == piece.body && l.rodA == rod.key;
    });
}

/// The way of a held point relative to one outline in the coming frame.
struct Approach {
    const World& world;
    const Hold& hold;
    const Body& body;
    const contact::Outline& outline;
    double thickness; ///< of the shell, m

    /// Between the surfaces, the point and the body each at their own time, m.
    [[nodiscard]] double gap(double pointAt, double bodyAt) const {
        const Vec2 p = poseAfter(world, hold.target, pointAt).point;
        const double angle = body.state.angle + bodyAt * body.state.spin, c = math::cos(angle), s = math::sin(angle);
        const Vec2 arm = p - body.state.centre - bodyAt * body.state.velocity;
        return distance({c * arm.x() + s * arm.y(), c * arm.y() - s * arm.x()}, outline) - outline.radius -
               0.5 * thickness;
    }
    [[nodiscard]] double gap(double at) const { return gap(at, at); }

    /// Bound on the relative speed, m/s.
    [[nodiscard]] double speed(double frame) const {
        const Path& p = hold.target.path;
        double own = hold.target.velocity.norm();
        if (p.active)
            own = 1.5 * (p.to - p.from).norm() / (p.end - p.start) + p.fromVelocity.norm() + p.toVelocity.norm();
        const double body_ = body.state.velocity.norm();
        const double arm = (hold.target.point - body.state.centre).norm() + frame * (own + body_);
        return own + body_ + std::abs(body.state.spin) * arm;
    }

    /// When the point is driven in, s from now; infinite: not in this frame.
    [[nodiscard]] double meets(double frame) const;
};

double Approach::meets(double frame) const {
    const double h = thickness, first = gap(0.0), fastest = speed(frame);
    if (!(fastest > 0.0) || first < -kInside * h || !(first <= fastest * frame))
        return kInfinity;
    const double rest = std::min(kRest * h, first), in = std::min(-kTouch * h, first - 1e-6 * h);
    double out = 0.0, entered = kInfinity;
    for (double t = 0.0;;) {
        const double g = gap(t);
        if (g >= rest && !(entered < kInfinity))
            out = t;
        if (g < in)
            entered = std::min(entered, t);
        else
            entered = kInfinity;
        if (g < -kShallow * h || (t >= frame && entered < kInfinity))
            break;
        if (t >= frame)
            return kInfinity;
        t = std::min(frame, t + std::max(g - in, kShallow * h) / fastest);
    }
    double deep = std::min(entered, frame);
    for (int i = 0; i < 60 && deep - out > 1e-12 * frame; ++i) {
        const double middle = 0.5 * (out + deep);
        (gap(middle) >= rest ? out : deep) = middle;
    }
    return out;
}

/// Whether it is the point that goes in at `at`, not only the body that comes.
bool isDriven(const Approach& a, double at, double frame) {
    const double later = at + 1e-3 * frame;
    return a.gap(later, at) < a.gap(at, at) - 1e-9 * a.thickness;
}

void stopHold(const World& world, double frame, const Rod& rod, Hold& hold) {
    HoldStop& stop = hold.stop;
    stop.byHoldBefore = stop.byHold && stop.time <= world.time;
    stop.byHold = false;
    stop.time = kInfinity;
    const double thickness = rod.model.definition().thickness;
    double touch = kInfinity;
    bool leaves = true, driven = false;
    BodyId touched = 0;
    for (const BodyOutline& piece : world.outlines) {
        const int index = bodyIndex(world, piece.body);
        SC_ASSERT(index >= 0, "an outline belongs to a body");
        const Body& body = world.bodies[static_cast<std::size_t>(index)];
        if (body.yields() || body.driven || filtered(world, rod, piece))
            continue;
        const Approach way{world, hold, body, piece.local, thickness};
        if (piece.body == stop.body && way.gap(0.0) <= kLeft * thickness)
            leaves = false;
        const double at = way.meets(frame);
        if (!(at < kInfinity) || passes(world, rod, piece))
            continue;
        const bool own = isDriven(way, at, frame);
        if (own)
            stop.time = std::min(stop.time, world.time + at);
        if (at < touch || (at == touch && own)) {
            touch = at;
            touched = piece.body;
            driven = own;
        }
    }
    if (stop.body != 0 && leaves)
        stop.body = 0;
    if (touched != 0 && stop.body == 0) {
        stop.body = touched;
        stop.since = world.time + touch;
        stop.driven = driven;
    }
}

} // namespace

void stopHolds(World& world, double frame) {
    for (Rod& rod : world.rods) {
        if (rod.quarantined)
            continue;
        for (Hold& hold : rod.holds)
            if (!hold.onCrosshead)
                stopHold(world, frame, rod, hold);
        if (rod.holds.size() > 1)
            stopHeldPairs(world, frame, rod);
    }
}

} // namespace supercircle::step
