#include "supercircle/contact/crossing/swept_motion.h"

#include "supercircle/support/elementary.h"
#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::contact::crossing_check {

namespace {

Vec2 rotated(const Vec2& v, double angle) {
    const math::SinCos a = math::sinCosSmall(angle);
    return a.cosine * v + a.sine * rod::perp(v);
}

/// The same direction's angle in [-pi, pi].
double wrapped(double angle) {
    return std::abs(angle) < M_PI ? angle : std::remainder(angle, 2.0 * M_PI);
}

Vec2 startOf(const Arc& arc, double s) {
    return s == 0.0 ? arc.start : arc.pointAt(s);
}

/// Sets the start configuration from [s, s + length] of an arc.
void setBefore(MovingArc& m, const Arc& from, double s, double length) {
    m.angle = from.angleAt(s + 0.5 * length);
    m.before = makeArcFromStart(startOf(from, s), m.angle, from.curvature, 0.5 * length);
    m.complete = false;
}

/// Completes the motion, which ends on arc `to`.
void setMotion(MovingArc& m, const Arc& from, const Arc& to, double s, double length, const RigidMotion& frame) {
    const double mid = s + 0.5 * length;
    m.complete = true;
    m.frame = frame;
    m.arm = m.before.mid - m.frame.reference;
    m.armChange = m.shift = Vec2::Zero();
    m.turn = m.curvatureChange = m.pathBound = m.endMismatch = 0.0;
    m.box = AlignedBox{};
    m.box.include(m.before);
    double accelerationBound = 0.0; // of any point, as a second derivative by the motion parameter
    if (from.start != to.start || from.angle != to.angle || from.curvature != to.curvature) {
        const CircularArc last = makeArcFromStart(startOf(to, s), to.angleAt(mid), to.curvature, 0.5 * length);
        const Vec2 turned = last.mid - m.frame.reference - m.frame.shift;
        m.armChange = m.frame.back.x() * turned + m.frame.back.y() * rod::perp(turned) - m.arm;
        m.shift = last.mid - m.before.mid;
        m.turn = wrapped(to.angleAt(mid) - m.angle);
        m.curvatureChange = to.curvature - from.curvature;
        const double half = m.before.half;
        const double omega = std::abs(m.frame.turn);
        const double centripetal =
            omega * omega * (m.arm.norm() + m.armChange.norm()) + 2.0 * omega * m.armChange.norm();
        const double rate = std::abs(m.turn) + half * std::abs(m.curvatureChange);
        const double ownRate = std::abs(m.turn - m.frame.turn) + half * std::abs(m.curvatureChange);
        accelerationBound = centripetal + half * rate * rate;
        m.pathBound = half * std::abs(m.turn) + 0.5 * half * half * std::abs(m.curvatureChange) + 0.5 * centripetal;
        m.endMismatch = 0.125 * half * ownRate * ownRate; // a path leaves its chord by at most an eighth of that bound
        m.box.include(last);
    }
    SC_ASSERT_EXPENSIVE(!(m.pathBound < 0.0) && !(m.endMismatch < 0.0) && !(accelerationBound < 0.0),
                        "bounds are not negative");
    m.box.enlarge(0.125 * accelerationBound + m.endMismatch + 1e-3 * m.halfThickness + 1e-12);
}

struct Section {
    Vec2 point = Vec2::Zero();
    double angle = 0.0;
};

/// Uses the section that moves least as the reference of the rigid motion.
void consider(const Section& before, const Section& after, double& least, RigidMotion& frame) {
    const Vec2 shift = after.point - before.point;
    if (!(shift.norm() < least))
        return;
    least = shift.norm();
    frame.reference = before.point;
    frame.shift = shift;
    frame.turn = wrapped(after.angle - before.angle);
}

void finish(RigidMotion& frame) {
    const math::SinCos a = math::sinCosSmall(frame.turn);
    frame.back = {a.cosine, -a.sine};
}

/// From the ends and the middle of a rod.
RigidMotion frameBetween(const RodCurve& from, const RodCurve& to) {
    RigidMotion frame;
    double least = INFINITY;
    const auto sectionAt = [](const Arc& arc, double s) {
        return Section{s == 0.0 ? arc.start : arc.pointAt(s), arc.angleAt(s)};
    };
    const auto at = [&](std::size_t e, double s0, double s1) {
        consider(sectionAt(from.arcs[e], s0), sectionAt(to.arcs[e], s1), least, frame);
    };
    const std::size_t n = from.arcs.size();
    at(0, 0.0, 0.0);
    at(n / 2, 0.0, 0.0);
    at(n - 1, from.arcs.back().length, to.arcs.back().length);
    finish(frame);
    return frame;
}

/// From the corners of an outline with the direction of its first edge.
RigidMotion frameBetween(const Outline& from, const Outline& to) {
    RigidMotion frame;
    double least = INFINITY;
    const auto direction = [](const Outline& o) {
        const Vec2 edge = o.points.size() > 1 ? Vec2(o.points[1] - o.points[0]) : Vec2(1.0, 0.0);
        return math::atan2(edge.y(), edge.x());
    };
    const double angleFrom = direction(from);
    const double angleTo = direction(to);
    for (std::size_t i = 0; i < from.points.size(); ++i)
        consider({from.points[i], angleFrom}, {to.points[i], angleTo}, least, frame);
    finish(frame);
    return frame;
}

/// Upper bound of how far an arc extends beyond the box of its ends, m.
double bulge(const Arc& arc, double length) {
    const double turn = std::abs(arc.curvature) * length;
    return turn <= kMaxTurn ? 0.125 * length * turn : 0.5 * length;
}

double extent(const Vec2& v) {
    return std::abs(v.x()) + std::abs(v.y());
}

/// Padding of the boxes around the element ends so that they contain the whole motion, m: the bounds of setMotion, from
/// the motion of the element starts, for the worst element. Fills `bound` likewise.
double padding(const RodCurve& from, const RodCurve& to, const RigidMotion& frame, MotionBound& bound) {
    double length = 0.0, bulges = 0.0, rate = 0.0, ownRate = 0.0, arm = 0.0, start = 0.0;
    for (std::size_t e = 0; e < from.arcs.size(); ++e) {
        const Arc& a = from.arcs[e];
        const Arc& b = to.arcs[e];
        const double half = 0.5 * a.length;
        const double curvatureChange = half * std::abs(b.curvature - a.curvature);
        const double turn = wrapped(b.angleAt(half) - a.angleAt(half));
        length = std::max(length, a.length);
        bulges = std::max({bulges, bulge(a, a.length), bulge(b, a.length)});
        rate = std::max(rate, std::abs(turn) + curvatureChange);
        ownRate = std::max(ownRate, std::abs(turn - frame.turn) + curvatureChange);
        arm = std::max(arm, extent(a.start - frame.reference));
        start = std::max(start, extent(b.start - a.start - frame.shift));
    }
    // The middles of a divided element may lie anywhere on it.
    const double omega = std::abs(frame.turn);
    const double armChange = start + length * rate + omega * (arm + length);
    const double centripetal = omega * omega * (arm + length + armChange) + 2.0 * omega * armChange;
    bound.path = extent(frame.shift) + start + 1.5 * length * rate + 0.5 * centripetal;
    bound.endMismatch = 0.0625 * length * ownRate * ownRate;
    return bulges + 0.125 * (centripetal + 0.5 * length * (rate * rate + ownRate * ownRate)) +
           1e-3 * from.halfThickness + 1e-9 * length + 1e-12;
}

bool unmoved(const RodCurve& a, const RodCurve& b) {
    return std::equal(a.arcs.begin(), a.arcs.end(), b.arcs.begin(), b.arcs.end(), [](const Arc& p, const Arc& q) {
        return p.start == q.start && p.angle == q.angle && p.curvature == q.curvature && p.length == q.length;
    });
}

int cuts(double turn) {
    return std::max(1, static_cast<int>(std::ceil(std::abs(turn) / kMaxTurn)));
}

Arc straight(const Vec2& a, const Vec2& b) {
    Arc arc;
    arc.start = a;
    arc.angle = math::atan2(b.y() - a.y(), b.x() - a.x());
    arc.length = (b - a).norm();
    return arc;
}

} // namespace

CircularArc MovingArc::at(double lambda) const {
    const Vec2 mid = frame.reference + lambda * frame.shift + rotated(arm + lambda * armChange, lambda * frame.turn);
    return makeArc(mid, angle + lambda * turn, before.curvature + lambda * curvatureChange, before.half);
}

void ElementBoxes::resize(std::size_t n) {
    for (std::vector<double>* v : {&lowX, &lowY, &highX, &highY})
        v->resize(n);
}

void SweptMotion::prepare(const std::vector<RodCurve>& first, const std::vector<RodCurve>& last,
                          const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                          const parallel::For& loop) {
    before = &first;
    after = &last;
    rods.assign(std::min(first.size(), last.size()), RodMotion{});
    std::size_t elements = 0;
    for (std::size_t r = 0; r < rods.size(); ++r) {
        rods[r].first = elements;
        elements += first[r].arcs.size();
    }
    boxes.resize(elements);
    SC_ASSERT(boxes.lowX.size() == elements && boxes.highY.size() == elements, "one box an element");
    parallel::forEach(loop, rods.size(), 32, [this](std::size_t r) { addRod(r); });
    outlines.clear();
    for (std::size_t o = 0; o < outlinesBefore.size() && o < outlinesAfter.size(); ++o)
        addOutline(o, outlinesBefore[o], outlinesAfter[o]);
}

void SweptMotion::addRod(std::size_t r) {
    const RodCurve& from = (*before)[r];
    const RodCurve& to = (*after)[r];
    RodMotion& rodMotion = rods[r];
    const std::size_t n = from.arcs.size();
    if (n == 0 || n != to.arcs.size())
        return;
    rodMotion.count = n;
    rodMotion.still = from.resting && to.resting && unmoved(from, to);
    rodMotion.frame = frameBetween(from, to);
    const double pad = padding(from, to, rodMotion.frame, rodMotion.bound);
    Vec2 low = from.arcs[0].start.cwiseMin(to.arcs[0].start);
    Vec2 high = from.arcs[0].start.cwiseMax(to.arcs[0].start);
    for (std::size_t e = 0; e < n; ++e) {
        const Arc& last = from.arcs[e];
        const Vec2 end = e + 1 < n ? from.arcs[e + 1].start : last.pointAt(last.length);
        const Vec2 endAfter = e + 1 < n ? to.arcs[e + 1].start : to.arcs[e].pointAt(last.length);
        const Vec2 nextLow = end.cwiseMin(endAfter);
        const Vec2 nextHigh = end.cwiseMax(endAfter);
        const std::size_t i = rodMotion.first + e;
        boxes.lowX[i] = std::min(low.x(), nextLow.x()) - pad;
        boxes.lowY[i] = std::min(low.y(), nextLow.y()) - pad;
        boxes.highX[i] = std::max(high.x(), nextHigh.x()) + pad;
        boxes.highY[i] = std::max(high.y(), nextHigh.y()) + pad;
        rodMotion.box.include(low);
        rodMotion.box.include(high);
        low = nextLow;
        high = nextHigh;
    }
    rodMotion.box.include(low);
    rodMotion.box.include(high);
    rodMotion.box.enlarge(pad);
    if (!(rodMotion.box.upper - rodMotion.box.lower).allFinite())
        rodMotion.count = 0;
}

void MovingArcs::begin(const SweptMotion& motion) {
    motion_ = &motion;
    used_ = 0;
    ++search_;
    if (ranges_.size() < motion.boxes.lowX.size())
        ranges_.resize(motion.boxes.lowX.size());
}

MovingArcs::ArcRange MovingArcs::arcsOf(std::size_t rod, std::size_t element) {
    ArcRange& range = ranges_[motion_->rods[rod].first + element];
    if (range.search == search_)
        return range;
    const RodCurve& from = (*motion_->before)[rod];
    const Arc& arc = from.arcs[element];
    const Arc& to = (*motion_->after)[rod].arcs[element];
    const int n = std::max(cuts(arc.curvature * arc.length), cuts(to.curvature * arc.length));
    range = {used_, static_cast<std::size_t>(n), search_};
    used_ += range.count;
    if (arcs_.size() < used_)
        arcs_.resize(std::max(used_, 2 * arcs_.size()));
    const double length = arc.length / n;
    for (int i = 0; i < n; ++i) {
        MovingArc& m = arcs_[range.first + static_cast<std::size_t>(i)];
        m.rod = static_cast<std::int32_t>(rod);
        m.element = static_cast<std::int32_t>(element);
        m.halfThickness = from.halfThickness;
        setBefore(m, arc, i * length, length);
        m.s0 = (element < from.nodeS.size() ? from.nodeS[element] : 0.0) + (i + 0.5) * length;
    }
    return range;
}

const MovingArc& MovingArcs::completed(std::size_t i) {
    MovingArc& m = arcs_[i];
    if (m.complete)
        return m;
    const auto rod = static_cast<std::size_t>(m.rod);
    const auto element = static_cast<std::size_t>(m.element);
    const ArcRange range = ranges_[motion_->rods[rod].first + element];
    const Arc& from = (*motion_->before)[rod].arcs[element];
    const double length = from.length / static_cast<double>(range.count);
    const double s = static_cast<double>(i - range.first) * length;
    setMotion(m, from, (*motion_->after)[rod].arcs[element], s, length, motion_->rods[rod].frame);
    return m;
}

void SweptMotion::addOutline(std::size_t o, const Outline& from, const Outline& to) {
    if (from.points.empty() || to.points.size() != from.points.size())
        return;
    if (from.kind == OutlineKind::Circle && from.radius <= 0.0)
        return;
    MovingArc m;
    m.outline = static_cast<std::int32_t>(o);
    const RigidMotion frame = frameBetween(from, to);
    const auto add = [&](const Arc& arc, const Arc& moved) {
        setBefore(m, arc, 0.0, arc.length);
        setMotion(m, arc, moved, 0.0, arc.length, frame);
        outlines.push_back(m);
    };
    if (from.kind == OutlineKind::Circle) {
        for (int i = 0; i < 4; ++i) {
            Arc arc;
            arc.curvature = 1.0 / from.radius;
            arc.length = 0.5 * M_PI * from.radius;
            arc.angle = 0.5 * M_PI * (i + 1);
            const Vec2 radius = from.radius * Vec2(math::cos(0.5 * M_PI * i), math::sin(0.5 * M_PI * i));
            arc.start = from.points[0] + radius;
            Arc moved = arc;
            moved.start = to.points[0] + radius;
            add(arc, moved);
        }
        return;
    }
    const std::size_t n = from.points.size();
    const std::size_t edges = from.kind == OutlineKind::Polygon ? n : n - 1;
    for (std::size_t i = 0; i < edges; ++i)
        add(straight(from.points[i], from.points[(i + 1) % n]), straight(to.points[i], to.points[(i + 1) % n]));
}

} // namespace supercircle::contact::crossing_check
