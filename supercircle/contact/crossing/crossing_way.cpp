#include "supercircle/contact/crossing/crossing_way.h"

#include <algorithm>

namespace supercircle::contact::witness {

namespace {

Vec2 rotated(const Vec2& v, double angle) {
    const rod::SinCos a = rod::sinCosSmall(angle);
    return a.cosine * v + a.sine * rod::perp(v);
}

/// The same direction's angle in [-pi, pi].
double wrapped(double angle) {
    return std::abs(angle) < M_PI ? angle : std::remainder(angle, 2.0 * M_PI);
}

Vec2 startOf(const Arc& arc, double s) {
    return s == 0.0 ? arc.start : arc.pointAt(s);
}

/// Sets the piece of an arc on [s, s + length].
void setBefore(Moving& m, const Arc& from, double s, double length) {
    m.angle = from.angleAt(s + 0.5 * length);
    m.before = makePieceFrom(startOf(from, s), m.angle, from.curvature, 0.5 * length);
    m.complete = false;
}

/// Completes it with the way to arc `to`.
void setWay(Moving& m, const Arc& from, const Arc& to, double s, double length, const Frame& frame) {
    const double mid = s + 0.5 * length;
    m.complete = true;
    m.frame = frame;
    m.arm = m.before.mid - m.frame.reference;
    m.drift = m.shift = Vec2::Zero();
    m.turn = m.bend = m.swing = m.gap = 0.0;
    m.box = AlignedBox{};
    m.box.include(m.before);
    double stray = 0.0; // bound on the second derivative of any point's way
    if (from.start != to.start || from.angle != to.angle || from.curvature != to.curvature) {
        const Piece last = makePieceFrom(startOf(to, s), to.angleAt(mid), to.curvature, 0.5 * length);
        const Vec2 turned = last.mid - m.frame.reference - m.frame.shift;
        m.drift = m.frame.back.x() * turned + m.frame.back.y() * rod::perp(turned) - m.arm;
        m.shift = last.mid - m.before.mid;
        m.turn = wrapped(to.angleAt(mid) - m.angle);
        m.bend = to.curvature - from.curvature;
        const double half = m.before.half;
        const double omega = std::abs(m.frame.turn);
        const double pull = omega * omega * (m.arm.norm() + m.drift.norm()) + 2.0 * omega * m.drift.norm();
        const double rate = std::abs(m.turn) + half * std::abs(m.bend);
        const double ownRate = std::abs(m.turn - m.frame.turn) + half * std::abs(m.bend);
        stray = pull + half * rate * rate;
        m.swing = half * std::abs(m.turn) + 0.5 * half * half * std::abs(m.bend) + 0.5 * pull;
        m.gap = 0.125 * half * ownRate * ownRate; // a way leaves its chord by at most an eighth of that bound
        m.box.include(last);
    }
    m.box.grow(0.125 * stray + m.gap + 1e-3 * m.halfThickness + 1e-12);
}

struct Place {
    Vec2 point = Vec2::Zero();
    double angle = 0.0;
};

/// Keeps the place that moves least as the frame's reference.
void consider(const Place& before, const Place& after, double& least, Frame& frame) {
    const Vec2 shift = after.point - before.point;
    if (!(shift.norm() < least))
        return;
    least = shift.norm();
    frame.reference = before.point;
    frame.shift = shift;
    frame.turn = wrapped(after.angle - before.angle);
}

void finish(Frame& frame) {
    const rod::SinCos a = rod::sinCosSmall(frame.turn);
    frame.back = {a.cosine, -a.sine};
}

/// From the ends and the middle of a rod.
Frame frameBetween(const Curve& from, const Curve& to) {
    Frame frame;
    double least = INFINITY;
    const auto place = [](const Arc& arc, double s) {
        return Place{s == 0.0 ? arc.start : arc.pointAt(s), arc.angleAt(s)};
    };
    const auto at = [&](std::size_t e, double s0, double s1) {
        consider(place(from.arcs[e], s0), place(to.arcs[e], s1), least, frame);
    };
    const std::size_t n = from.arcs.size();
    at(0, 0.0, 0.0);
    at(n / 2, 0.0, 0.0);
    at(n - 1, from.arcs.back().length, to.arcs.back().length);
    finish(frame);
    return frame;
}

/// From the corners of an outline with the direction of its first edge.
Frame frameBetween(const Outline& from, const Outline& to) {
    Frame frame;
    double least = INFINITY;
    const auto direction = [](const Outline& o) {
        const Vec2 edge = o.points.size() > 1 ? Vec2(o.points[1] - o.points[0]) : Vec2(1.0, 0.0);
        return std::atan2(edge.y(), edge.x());
    };
    const double angleFrom = direction(from);
    const double angleTo = direction(to);
    for (std::size_t i = 0; i < from.points.size(); ++i)
        consider({from.points[i], angleFrom}, {to.points[i], angleTo}, least, frame);
    finish(frame);
    return frame;
}

/// How far an arc bulges beyond the box of its ends at most, m.
double bulge(const Arc& arc, double length) {
    const double turn = std::abs(arc.curvature) * length;
    return turn <= kMaxTurn ? 0.125 * length * turn : 0.5 * length;
}

double extent(const Vec2& v) {
    return std::abs(v.x()) + std::abs(v.y());
}

/// What has to be added to the boxes of the ends of a rod's elements so that they hold the whole way: the bounds of
/// setWay, from the motion of the elements' starts, for the worst of them. `motion` likewise.
double padding(const Curve& from, const Curve& to, const Frame& frame, Motion& motion) {
    double length = 0.0, bulges = 0.0, rate = 0.0, ownRate = 0.0, arm = 0.0, start = 0.0;
    for (std::size_t e = 0; e < from.arcs.size(); ++e) {
        const Arc& a = from.arcs[e];
        const Arc& b = to.arcs[e];
        const double half = 0.5 * a.length;
        const double bend = half * std::abs(b.curvature - a.curvature);
        const double turn = wrapped(b.angleAt(half) - a.angleAt(half));
        length = std::max(length, a.length);
        bulges = std::max({bulges, bulge(a, a.length), bulge(b, a.length)});
        rate = std::max(rate, std::abs(turn) + bend);
        ownRate = std::max(ownRate, std::abs(turn - frame.turn) + bend);
        arm = std::max(arm, extent(a.start - frame.reference));
        start = std::max(start, extent(b.start - a.start - frame.shift));
    }
    // A cut element has its middles anywhere on it.
    const double omega = std::abs(frame.turn);
    const double drift = start + length * rate + omega * (arm + length);
    const double pull = omega * omega * (arm + length + drift) + 2.0 * omega * drift;
    motion.travel = extent(frame.shift) + start + 1.5 * length * rate + 0.5 * pull;
    motion.slack = 0.0625 * length * ownRate * ownRate;
    return bulges + 0.125 * (pull + 0.5 * length * (rate * rate + ownRate * ownRate)) + 1e-3 * from.halfThickness +
           1e-9 * length + 1e-12;
}

bool unmoved(const Curve& a, const Curve& b) {
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
    arc.angle = std::atan2(b.y() - a.y(), b.x() - a.x());
    arc.length = (b - a).norm();
    return arc;
}

} // namespace

Piece Moving::at(double lambda) const {
    const Vec2 mid = frame.reference + lambda * frame.shift + rotated(arm + lambda * drift, lambda * frame.turn);
    return makePiece(mid, angle + lambda * turn, before.curvature + lambda * bend, before.half);
}

void ElementBoxes::resize(std::size_t n) {
    for (std::vector<double>* v : {&lowX, &lowY, &highX, &highY})
        v->resize(n);
}

void Ways::prepare(const std::vector<Curve>& first, const std::vector<Curve>& last,
                   const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                   const parallel::For& loop) {
    before = &first;
    after = &last;
    rods.assign(std::min(first.size(), last.size()), RodWay{});
    std::size_t elements = 0;
    for (std::size_t r = 0; r < rods.size(); ++r) {
        rods[r].first = elements;
        elements += first[r].arcs.size();
    }
    boxes.resize(elements);
    parallel::forEach(loop, rods.size(), 32, [this](std::size_t r) { addRod(r); });
    outlines.clear();
    for (std::size_t o = 0; o < outlinesBefore.size() && o < outlinesAfter.size(); ++o)
        addOutline(o, outlinesBefore[o], outlinesAfter[o]);
}

void Ways::addRod(std::size_t r) {
    const Curve& from = (*before)[r];
    const Curve& to = (*after)[r];
    RodWay& way = rods[r];
    const std::size_t n = from.arcs.size();
    if (n == 0 || n != to.arcs.size())
        return;
    way.count = n;
    way.still = from.resting && to.resting && unmoved(from, to);
    way.frame = frameBetween(from, to);
    const double pad = padding(from, to, way.frame, way.motion);
    Vec2 low = from.arcs[0].start.cwiseMin(to.arcs[0].start);
    Vec2 high = from.arcs[0].start.cwiseMax(to.arcs[0].start);
    for (std::size_t e = 0; e < n; ++e) {
        const Arc& last = from.arcs[e];
        const Vec2 end = e + 1 < n ? from.arcs[e + 1].start : last.pointAt(last.length);
        const Vec2 endAfter = e + 1 < n ? to.arcs[e + 1].start : to.arcs[e].pointAt(last.length);
        const Vec2 nextLow = end.cwiseMin(endAfter);
        const Vec2 nextHigh = end.cwiseMax(endAfter);
        const std::size_t i = way.first + e;
        boxes.lowX[i] = std::min(low.x(), nextLow.x()) - pad;
        boxes.lowY[i] = std::min(low.y(), nextLow.y()) - pad;
        boxes.highX[i] = std::max(high.x(), nextHigh.x()) + pad;
        boxes.highY[i] = std::max(high.y(), nextHigh.y()) + pad;
        way.box.include(low);
        way.box.include(high);
        low = nextLow;
        high = nextHigh;
    }
    way.box.include(low);
    way.box.include(high);
    way.box.grow(pad);
    if (!(way.box.upper - way.box.lower).allFinite())
        way.count = 0;
}

void Pieces::begin(const Ways& ways) {
    ways_ = &ways;
    used_ = 0;
    ++search_;
    if (ranges_.size() < ways.boxes.lowX.size())
        ranges_.resize(ways.boxes.lowX.size());
}

Pieces::Range Pieces::of(std::size_t rod, std::size_t element) {
    Range& range = ranges_[ways_->rods[rod].first + element];
    if (range.search == search_)
        return range;
    const Curve& from = (*ways_->before)[rod];
    const Arc& arc = from.arcs[element];
    const Arc& to = (*ways_->after)[rod].arcs[element];
    const int n = std::max(cuts(arc.curvature * arc.length), cuts(to.curvature * arc.length));
    range = {used_, static_cast<std::size_t>(n), search_};
    used_ += range.count;
    if (pieces_.size() < used_)
        pieces_.resize(std::max(used_, 2 * pieces_.size()));
    const double length = arc.length / n;
    for (int i = 0; i < n; ++i) {
        Moving& m = pieces_[range.first + static_cast<std::size_t>(i)];
        m.rod = static_cast<std::int32_t>(rod);
        m.element = static_cast<std::int32_t>(element);
        m.halfThickness = from.halfThickness;
        setBefore(m, arc, i * length, length);
        m.s0 = (element < from.nodeS.size() ? from.nodeS[element] : 0.0) + (i + 0.5) * length;
    }
    return range;
}

const Moving& Pieces::completed(std::size_t i) {
    Moving& m = pieces_[i];
    if (m.complete)
        return m;
    const auto rod = static_cast<std::size_t>(m.rod);
    const auto element = static_cast<std::size_t>(m.element);
    const Range range = ranges_[ways_->rods[rod].first + element];
    const Arc& from = (*ways_->before)[rod].arcs[element];
    const double length = from.length / static_cast<double>(range.count);
    const double s = static_cast<double>(i - range.first) * length;
    setWay(m, from, (*ways_->after)[rod].arcs[element], s, length, ways_->rods[rod].frame);
    return m;
}

void Ways::addOutline(std::size_t o, const Outline& from, const Outline& to) {
    if (from.points.empty() || to.points.size() != from.points.size())
        return;
    if (from.kind == OutlineKind::Circle && from.radius <= 0.0)
        return;
    Moving m;
    m.outline = static_cast<std::int32_t>(o);
    const Frame frame = frameBetween(from, to);
    const auto add = [&](const Arc& arc, const Arc& moved) {
        setBefore(m, arc, 0.0, arc.length);
        setWay(m, arc, moved, 0.0, arc.length, frame);
        outlines.push_back(m);
    };
    if (from.kind == OutlineKind::Circle) {
        for (int i = 0; i < 4; ++i) {
            Arc arc;
            arc.curvature = 1.0 / from.radius;
            arc.length = 0.5 * M_PI * from.radius;
            arc.angle = 0.5 * M_PI * (i + 1);
            const Vec2 radius = from.radius * Vec2(std::cos(0.5 * M_PI * i), std::sin(0.5 * M_PI * i));
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

} // namespace supercircle::contact::witness
