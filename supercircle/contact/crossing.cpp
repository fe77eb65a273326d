// The witness. Every element, wall segment and solid face becomes pieces of circles; pairs whose boxes meet are tested
// by exact intersection. Between two configurations the pieces' middles, angles and curvatures are interpolated.
//
// Sampling the way evenly is not enough: two parallel centre lines that pass through each other sideways intersect at
// one instant only, between any two samples. So the way is walked by conservative advancement: from a moment at
// distance d nothing can meet before the pieces have moved by d relative to each other; the next sample is there. Near
// contact the samples get finer by themselves, and a walk whose distance falls below a thousandth of the thickness is a
// crossing.
//
// What is not seen or counted more strictly than the eye would:
// - Neighbouring elements of a rod are not tested against each other: circles that touch at a common tangent meet
// nowhere
//   else. An element that turns by 2 pi overlaps itself and counts.
// - One-sided edges count from either side when a centre line crosses them; element ends and middles also count when
// they
//   lie behind an edge's own stretch by less than the rod's thickness (deeper, a rod is taken to live behind the edge).
//   Two antiparallel edges closer than that thickness would accuse each other's visitors.
// - Pairs whose filters exclude each other may cross as they like.
// - A pair of rods, or rod and outline, is reported once a configuration pair by the swept test.

#include "supercircle/contact/crossing.h"

#include "supercircle/contact/crossing_piece.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace supercircle::contact {

namespace {

using witness::Meeting;
using witness::Piece;

struct AlignedBox {
    Vec2 lower = Vec2::Constant(INFINITY);
    Vec2 upper = Vec2::Constant(-INFINITY);
    void include(const Vec2& p) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    void include(const Piece& p) {
        include(p.start);
        include(p.end);
        include(p.apex);
    }
    void include(const AlignedBox& b) {
        lower = lower.cwiseMin(b.lower);
        upper = upper.cwiseMax(b.upper);
    }
    [[nodiscard]] bool meets(const AlignedBox& b) const {
        return lower.x() <= b.upper.x() && b.lower.x() <= upper.x() && lower.y() <= b.upper.y() &&
               b.lower.y() <= upper.y();
    }
};

/// The rigid part of a way: `reference` moves straight by `shift` while the rest turns about it by `turn`.
struct Frame {
    Vec2 reference = Vec2::Zero();
    Vec2 shift = Vec2::Zero();
    double turn = 0.0;
    Vec2 back{1.0, 0.0}; ///< cosine and sine of -turn
};

Vec2 rotated(const Vec2& v, double angle) {
    return std::cos(angle) * v + std::sin(angle) * rod::perp(v);
}

/// A piece on its way from one configuration to the next.
struct Moving {
    Piece before;
    Frame frame;
    Vec2 arm = Vec2::Zero();   ///< from the frame's reference to the middle, before, m
    Vec2 drift = Vec2::Zero(); ///< change of the arm in the frame, m
    Vec2 shift = Vec2::Zero(); ///< of the middle, from first to last, m
    double angle = 0.0;        ///< before, at the middle, rad
    double turn = 0.0;         ///< rad
    double bend = 0.0;         ///< change of curvature, 1/m
    double swing = 0.0;        ///< bound on any point's path beyond the middle's mean motion, m
    double gap = 0.0;          ///< bound on how far an end strays from its neighbour's on the way, m
    AlignedBox box;            ///< of the whole way
    double s0 = 0.0;           ///< arc length on the rod at the middle
    std::int32_t rod = -1;
    std::int32_t element = -1;
    std::int32_t outline = -1;
    double halfThickness = 0.0;
    std::uint32_t category = 1;
    std::uint32_t mask = 0xffffffffu;

    [[nodiscard]] Piece at(double lambda) const {
        const Vec2 mid = frame.reference + lambda * frame.shift + rotated(arm + lambda * drift, lambda * frame.turn);
        return witness::makePiece(mid, angle + lambda * turn, before.curvature + lambda * bend, before.half);
    }
};

bool filtersAgree(const Moving& a, const Moving& b) {
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

/// Sets the way from arc `from` to arc `to`, both cut to [s, s + length].
void setWay(Moving& m, const Arc& from, const Arc& to, double s, double length) {
    const double mid = s + 0.5 * length;
    const auto startOf = [s](const Arc& arc) { return s == 0.0 ? arc.start : arc.pointAt(s); };
    m.angle = from.angleAt(mid);
    m.before = witness::makePieceFrom(startOf(from), m.angle, from.curvature, 0.5 * length);
    m.arm = m.before.mid - m.frame.reference;
    const bool moves = from.start != to.start || from.angle != to.angle || from.curvature != to.curvature;
    m.box.include(m.before);
    double stray = 0.0; // bound on the second derivative of any point's way
    if (moves) {
        const Piece last = witness::makePieceFrom(startOf(to), to.angleAt(mid), to.curvature, 0.5 * length);
        const Vec2 turned = last.mid - m.frame.reference - m.frame.shift;
        m.drift = m.frame.back.x() * turned + m.frame.back.y() * rod::perp(turned) - m.arm;
        m.shift = last.mid - m.before.mid;
        m.turn = std::remainder(to.angleAt(mid) - m.angle, 2.0 * M_PI);
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
    const Vec2 pad = Vec2::Constant(0.125 * stray + m.gap + 1e-3 * m.halfThickness + 1e-12);
    m.box.lower -= pad;
    m.box.upper += pad;
}

struct Place {
    Vec2 point = Vec2::Zero();
    double angle = 0.0;
};

Frame frameBetween(const std::vector<Place>& before, const std::vector<Place>& after) {
    Frame frame;
    double least = INFINITY;
    for (std::size_t i = 0; i < before.size(); ++i) {
        const Vec2 shift = after[i].point - before[i].point;
        if (shift.norm() < least) {
            least = shift.norm();
            frame.reference = before[i].point;
            frame.shift = shift;
            frame.turn = std::remainder(after[i].angle - before[i].angle, 2.0 * M_PI);
        }
    }
    frame.back = {std::cos(frame.turn), -std::sin(frame.turn)};
    return frame;
}

/// Ends and middle of a rod.
std::vector<Place> places(const Curve& c) {
    const auto at = [](const Arc& arc, double s) { return Place{arc.pointAt(s), arc.angleAt(s)}; };
    return {at(c.arcs.front(), 0.0), at(c.arcs[c.arcs.size() / 2], 0.0), at(c.arcs.back(), c.arcs.back().length)};
}

/// Corners of an outline with the direction of its first edge.
std::vector<Place> places(const Outline& o) {
    std::vector<Place> out;
    const Vec2 edge = o.points.size() > 1 ? Vec2(o.points[1] - o.points[0]) : Vec2(1.0, 0.0);
    for (const Vec2& p : o.points)
        out.push_back({p, std::atan2(edge.y(), edge.x())});
    return out;
}

int cuts(double turn) {
    return std::max(1, static_cast<int>(std::ceil(std::abs(turn) / witness::kMaxTurn)));
}

void addRods(const std::vector<Curve>& before, const std::vector<Curve>& after, std::vector<Moving>& out) {
    std::size_t elements = 0;
    for (const Curve& c : before)
        elements += c.arcs.size();
    out.reserve(elements + elements / 8 + 64); // room for some cuts and the outlines
    for (std::size_t r = 0; r < before.size() && r < after.size(); ++r) {
        const Curve& from = before[r];
        const Curve& to = after[r];
        if (from.arcs.empty() || from.arcs.size() != to.arcs.size())
            continue;
        const Frame frame = frameBetween(places(from), places(to));
        for (std::size_t e = 0; e < from.arcs.size(); ++e) {
            const Arc& arc = from.arcs[e];
            const int n = std::max(cuts(arc.curvature * arc.length), cuts(to.arcs[e].curvature * arc.length));
            for (int i = 0; i < n; ++i) {
                Moving& m = out.emplace_back();
                m.frame = frame;
                m.rod = static_cast<std::int32_t>(r);
                m.element = static_cast<std::int32_t>(e);
                m.halfThickness = from.halfThickness;
                m.category = from.category;
                m.mask = from.mask;
                const double length = arc.length / n;
                setWay(m, arc, to.arcs[e], i * length, length);
                m.s0 = (e < from.nodeS.size() ? from.nodeS[e] : 0.0) + (i + 0.5) * length;
            }
        }
    }
}

Arc straight(const Vec2& a, const Vec2& b) {
    Arc arc;
    arc.start = a;
    arc.angle = std::atan2(b.y() - a.y(), b.x() - a.x());
    arc.length = (b - a).norm();
    return arc;
}

void addOutlines(const std::vector<Outline>& before, const std::vector<Outline>& after, std::vector<Moving>& out) {
    for (std::size_t o = 0; o < before.size() && o < after.size(); ++o) {
        const Outline& from = before[o];
        const Outline& to = after[o];
        Moving m;
        m.outline = static_cast<std::int32_t>(o);
        m.category = from.category;
        m.mask = from.mask;
        if (from.points.empty() || to.points.size() != from.points.size())
            continue;
        if (from.kind == OutlineKind::Circle && from.radius <= 0.0)
            continue;
        m.frame = frameBetween(places(from), places(to));
        if (from.kind == OutlineKind::Circle) {
            for (int i = 0; i < 4; ++i) {
                Moving quarter = m;
                Arc arc;
                arc.curvature = 1.0 / from.radius;
                arc.length = 0.5 * M_PI * from.radius;
                arc.angle = 0.5 * M_PI * (i + 1);
                const Vec2 radius = from.radius * Vec2(std::cos(0.5 * M_PI * i), std::sin(0.5 * M_PI * i));
                arc.start = from.points[0] + radius;
                Arc moved = arc;
                moved.start = to.points[0] + radius;
                setWay(quarter, arc, moved, 0.0, arc.length);
                out.push_back(quarter);
            }
            continue;
        }
        const std::size_t n = from.points.size();
        const std::size_t edges = from.kind == OutlineKind::Polygon ? n : n - 1;
        for (std::size_t i = 0; i < edges; ++i) {
            Moving edge = m;
            const Arc arc = straight(from.points[i], from.points[(i + 1) % n]);
            setWay(edge, arc, straight(to.points[i], to.points[(i + 1) % n]), 0.0, arc.length);
            out.push_back(edge);
        }
    }
}

bool neighbours(const Moving& a, const Moving& b, const std::vector<Curve>& curves) {
    const std::int32_t apart = std::abs(a.element - b.element);
    if (apart <= 1)
        return true;
    const Curve& c = curves[static_cast<std::size_t>(a.rod)];
    return c.closed && apart + 1 == static_cast<std::int32_t>(c.arcs.size());
}

/// Calls test(a, b) for all pairs that involve a rod (as a) and whose boxes meet; order depends on geometry only.
template <class Test>
void forPairs(const std::vector<Moving>& pieces, const std::vector<Curve>& curves, Test test) {
    struct Entry { // what the sweep reads, close together
        AlignedBox box;
        std::uint32_t index = 0;
    };
    std::vector<Entry> order(pieces.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = {pieces[i].box, static_cast<std::uint32_t>(i)};
    std::sort(order.begin(), order.end(), [](const Entry& a, const Entry& b) {
        return a.box.lower.x() != b.box.lower.x() ? a.box.lower.x() < b.box.lower.x() : a.index < b.index;
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
        const AlignedBox box = order[i].box;
        for (std::size_t j = i + 1; j < order.size() && order[j].box.lower.x() <= box.upper.x(); ++j) {
            if (order[j].box.lower.y() > box.upper.y() || order[j].box.upper.y() < box.lower.y())
                continue;
            // Rods come before outlines in `pieces`, so the lower index is a rod if there is one.
            const Moving& a = pieces[std::min(order[i].index, order[j].index)];
            const Moving& b = pieces[std::max(order[i].index, order[j].index)];
            if (a.rod < 0 || !filtersAgree(a, b) || (a.rod == b.rod && neighbours(a, b, curves)))
                continue;
            test(a, b);
        }
    }
}

Crossing crossingOf(const Moving& a, const Moving& b, double s, const Vec2& where) {
    Crossing c;
    c.rodA = a.rod;
    c.rodB = b.rod;
    c.outline = b.outline;
    c.sA = a.s0 + s;
    c.where = where;
    return c;
}

/// Walks the way of a pair; true (and where) if the centre lines meet on it, both ends of the way included.
bool meetOnTheWay(const Moving& a, const Moving& b, Crossing& out) {
    const double way = (a.shift - b.shift).norm() + a.swing + b.swing;
    const double slack = a.gap + b.gap;
    if (witness::separation(a.before, b.before) > way + 2.0 * slack)
        return false;
    const double near = std::max(1e-3 * (a.halfThickness + b.halfThickness), 1e-9 * (a.before.half + b.before.half));
    for (double lambda = 0.0;;) {
        const Piece pa = lambda == 0.0 ? a.before : a.at(lambda);
        const Piece pb = lambda == 0.0 ? b.before : b.at(lambda);
        const double extra = lambda == 0.0 || lambda == 1.0 ? 0.0 : slack;
        std::array<Meeting, 2> meetings;
        if (witness::intersect(pa, pb, extra, meetings) > 0) {
            out = crossingOf(a, b, meetings[0].sA, meetings[0].where);
            return true;
        }
        const double d = witness::distance(pa, pb);
        if (d < near && way > 0.0) {
            out = crossingOf(a, b, 0.0, pa.mid);
            return true;
        }
        const double clear = d - 2.0 * slack;
        if (lambda >= 1.0 || !(clear < way * (1.0 - lambda))) // a motion that is not a number ends the walk, too
            return false;
        lambda = std::min(1.0, lambda + std::max(clear, near) / way);
    }
}

bool inside(const Vec2& p, const Outline& o) {
    if (o.kind == OutlineKind::Circle)
        return (p - o.points[0]).norm() < o.radius;
    for (std::size_t i = 0; i < o.points.size(); ++i) {
        const Vec2& a = o.points[i];
        if (!(rod::cross(o.points[(i + 1) % o.points.size()] - a, p - a) > 0.0))
            return false;
    }
    return true;
}

bool behind(const Vec2& p, const Outline& o, double depth) {
    const Vec2 edge = o.points[1] - o.points[0];
    const Vec2 q = p - o.points[0];
    const double length = edge.norm();
    const double side = rod::cross(edge, q) / length; // positive on the left, where rods belong
    const double along = edge.dot(q) / length;
    return side < 0.0 && side > -depth && along >= 0.0 && along <= length;
}

AlignedBox boxOf(const Outline& o, double pad) {
    AlignedBox box;
    for (const Vec2& p : o.points)
        box.include(p);
    const Vec2 margin = Vec2::Constant(pad + (o.kind == OutlineKind::Circle ? o.radius : 0.0));
    box.lower -= margin;
    box.upper += margin;
    return box;
}

/// Ends and middles of elements inside solids or just behind one-sided edges, one report for a rod and an outline.
/// `boxes` are those of the rods.
void findInside(const std::vector<Curve>& curves, const std::vector<AlignedBox>& boxes,
                const std::vector<Outline>& outlines, std::vector<Crossing>& out) {
    for (std::size_t o = 0; o < outlines.size(); ++o) {
        const Outline& outline = outlines[o];
        if (outline.kind == OutlineKind::Segment)
            continue;
        for (std::size_t r = 0; r < curves.size(); ++r) {
            const Curve& c = curves[r];
            const double depth = 2.0 * c.halfThickness;
            if ((c.category & outline.mask) == 0 || (outline.category & c.mask) == 0 ||
                !boxes[r].meets(boxOf(outline, depth)))
                continue;
            const auto report = [&](double s, const Vec2& p) {
                const bool hit = outline.kind == OutlineKind::OneSided ? behind(p, outline, depth) : inside(p, outline);
                if (hit)
                    out.push_back({static_cast<std::int32_t>(r), -1, static_cast<std::int32_t>(o), s, p});
                return hit;
            };
            bool found = false;
            for (std::size_t e = 0; e < c.arcs.size() && !found; ++e) {
                const Arc& arc = c.arcs[e];
                const double s = e < c.nodeS.size() ? c.nodeS[e] : 0.0;
                found = report(s, arc.start) || report(s + 0.5 * arc.length, arc.pointAt(0.5 * arc.length));
                if (!found && e + 1 == c.arcs.size())
                    found = report(s + arc.length, arc.pointAt(arc.length));
            }
        }
    }
}

std::vector<AlignedBox> rodBoxes(const std::vector<Moving>& pieces, std::size_t rods) {
    std::vector<AlignedBox> boxes(rods);
    for (const Moving& m : pieces) {
        if (m.rod >= 0)
            boxes[static_cast<std::size_t>(m.rod)].include(m.box);
    }
    return boxes;
}

void findOverturned(const std::vector<Curve>& curves, std::vector<Crossing>& out) {
    for (std::size_t r = 0; r < curves.size(); ++r) {
        for (std::size_t e = 0; e < curves[r].arcs.size(); ++e) {
            const Arc& arc = curves[r].arcs[e];
            const bool wholeRing = curves[r].closed && curves[r].arcs.size() == 1;
            if (std::abs(arc.curvature) * arc.length >= 2.0 * M_PI && !wholeRing) {
                const double s = e < curves[r].nodeS.size() ? curves[r].nodeS[e] : 0.0;
                out.push_back({static_cast<std::int32_t>(r), static_cast<std::int32_t>(r), -1, s, arc.start});
            }
        }
    }
}

auto pairOf(const Crossing& c) {
    return std::tie(c.rodA, c.rodB, c.outline);
}

void sortCrossings(std::vector<Crossing>& out) {
    std::sort(out.begin(), out.end(), [](const Crossing& a, const Crossing& b) {
        return std::tie(a.rodA, a.rodB, a.outline, a.sA) < std::tie(b.rodA, b.rodB, b.outline, b.sA);
    });
}

/// Keeps the first of each pair where `once` says so.
template <class Once>
void keepFirst(std::vector<Crossing>& out, Once once) {
    sortCrossings(out);
    out.erase(std::unique(out.begin(), out.end(),
                          [&](const Crossing& a, const Crossing& b) { return pairOf(a) == pairOf(b) && once(a); }),
              out.end());
}

} // namespace

void findCrossings(const std::vector<Curve>& curves, const std::vector<Outline>& outlines, std::vector<Crossing>& out) {
    out.clear();
    std::vector<Moving> pieces;
    addRods(curves, curves, pieces);
    addOutlines(outlines, outlines, pieces);
    forPairs(pieces, curves, [&](const Moving& a, const Moving& b) {
        if (witness::separation(a.before, b.before) > 0.0)
            return;
        std::array<Meeting, 2> meetings;
        const int n = witness::intersect(a.before, b.before, 0.0, meetings);
        for (int i = 0; i < n; ++i) {
            const Meeting& m = meetings[static_cast<std::size_t>(i)];
            out.push_back(crossingOf(a, b, m.sA, m.where));
        }
    });
    findInside(curves, rodBoxes(pieces, curves.size()), outlines, out);
    findOverturned(curves, out);
    keepFirst(out, [&](const Crossing& c) { // a solid is entered once, however often its faces are crossed
        return c.outline >= 0 && outlines[static_cast<std::size_t>(c.outline)].kind != OutlineKind::Segment;
    });
}

void findCrossingsSwept(const std::vector<Curve>& before, const std::vector<Curve>& after,
                        const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                        std::vector<Crossing>& out) {
    out.clear();
    std::vector<Moving> pieces;
    addRods(before, after, pieces);
    addOutlines(outlinesBefore, outlinesAfter, pieces);
    forPairs(pieces, before, [&](const Moving& a, const Moving& b) {
        Crossing c;
        if (meetOnTheWay(a, b, c))
            out.push_back(c);
    });
    findInside(after, rodBoxes(pieces, after.size()), outlinesAfter, out);
    findOverturned(after, out);
    keepFirst(out, [](const Crossing&) { return true; });
}

} // namespace supercircle::contact
