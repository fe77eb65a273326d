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
//   nowhere else. An element that turns by 2 pi overlaps itself and counts.
// - One-sided edges count from either side when a centre line crosses them; element ends and middles also count when
//   they lie behind an edge's own stretch by less than the rod's thickness (deeper, a rod is taken to live behind the
//   edge). Two antiparallel edges closer than that thickness would accuse each other's visitors.
// - Pairs whose filters exclude each other may cross as they like.
// - A pair of rods, or rod and outline, is reported once a configuration pair by the swept test.
// - Two rods marked as resting that are the same in both configurations are not tested by the swept test, nor one with
//   an outline that is.

#include "supercircle/contact/crossing.h"

#include "supercircle/contact/crossing/crossing_way.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace supercircle::contact {

namespace {

using witness::AlignedBox;
using witness::ElementBoxes;
using witness::Meeting;
using witness::Moving;
using witness::Piece;
using witness::Pieces;
using witness::RodWay;
using witness::Ways;

bool seesItself(const Curve& c) {
    return (c.category & c.mask) != 0;
}

template <class A, class B>
bool filtersAgree(const A& a, const B& b) {
    if (a.group == b.group && a.group != 0)
        return a.group > 0;
    return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

bool neighbours(std::size_t a, std::size_t b, const Curve& c) {
    const std::size_t apart = a < b ? b - a : a - b;
    return apart <= 1 || (c.closed && apart + 1 == c.arcs.size());
}

/// Rods by the lower ends of their boxes, in the direction in which they are spread widest.
struct Sweep {
    struct Item {
        double low, high;
        std::uint32_t rod;
        bool operator<(const Item& o) const { return low != o.low ? low < o.low : rod < o.rod; }
    };
    std::vector<Item> items;
    int across = 1; ///< the other direction

    void prepare(const Ways& ways);
};

/// Work space of one search; storage is kept.
struct Scratch {
    Pieces pieces;
    std::vector<std::uint32_t> elements;
    ElementBoxes boxes;
    std::vector<double> gaps;
};

/// The search for pairs whose boxes meet: rods by a sweep, their elements all against all.
class PairSearch {
public:
    PairSearch(const Ways& ways, const std::vector<Curve>& curves, bool skipStill, Scratch& scratch)
        : ways_(ways), curves_(curves), skipStill_(skipStill), scratch_(scratch) {
        scratch_.pieces.begin(ways);
    }

    /// Calls test(a, b) for all pairs of a rod of [begin, end) in the sweep with itself and those after it; order
    /// depends on geometry only.
    template <class Test>
    void rodPairs(const Sweep& sweep, std::size_t begin, std::size_t end, Test test);
    /// The same with outlines (as b). `outlineMoves[o]` tells whether an outline moves; a rod at rest meets only those.
    template <class Test>
    void outlinePairs(const std::vector<Outline>& outlines, const std::vector<char>& outlineMoves, Test test);

private:
    /// Elements of a rod whose boxes meet `box`, into `elements`.
    void near(const RodWay& rod, const AlignedBox& box, std::vector<std::uint32_t>& elements) const;
    template <class Test>
    void elementPairs(std::size_t a, std::size_t b, Test test);
    template <class Test>
    void piecePairs(std::size_t rodA, std::size_t a, std::size_t rodB, std::size_t b, Test test);

    const Ways& ways_;
    const std::vector<Curve>& curves_;
    bool skipStill_;
    Scratch& scratch_;
};

void Sweep::prepare(const Ways& ways) {
    Vec2 spread = Vec2::Zero(), sizes = Vec2::Zero();
    AlignedBox all;
    for (const RodWay& rod : ways.rods) {
        if (rod.count == 0)
            continue;
        all.include(rod.box.lower);
        all.include(rod.box.upper);
        sizes += rod.box.upper - rod.box.lower;
    }
    spread = all.upper - all.lower;
    const int axis = spread.x() * sizes.y() >= spread.y() * sizes.x() ? 0 : 1;
    across = 1 - axis;
    items.clear();
    for (std::size_t r = 0; r < ways.rods.size(); ++r) {
        const RodWay& rod = ways.rods[r];
        if (rod.count > 0)
            items.push_back({rod.box.lower[axis], rod.box.upper[axis], static_cast<std::uint32_t>(r)});
    }
    std::sort(items.begin(), items.end());
}

template <class Test>
void PairSearch::rodPairs(const Sweep& sweep, std::size_t begin, std::size_t end, Test test) {
    const std::vector<Sweep::Item>& items = sweep.items;
    const int across = sweep.across;
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t a = items[i].rod;
        const RodWay& rodA = ways_.rods[a];
        const bool still = skipStill_ && rodA.still;
        if (!still && seesItself(curves_[a]))
            elementPairs(a, a, test);
        for (std::size_t j = i + 1; j < items.size() && items[j].low <= items[i].high; ++j) {
            const std::size_t b = items[j].rod;
            const RodWay& rodB = ways_.rods[b];
            if (rodB.box.lower[across] > rodA.box.upper[across] || rodB.box.upper[across] < rodA.box.lower[across])
                continue;
            if ((still && rodB.still) || !filtersAgree(curves_[a], curves_[b]))
                continue;
            elementPairs(std::min(a, b), std::max(a, b), test);
        }
    }
}

void PairSearch::near(const RodWay& rod, const AlignedBox& box, std::vector<std::uint32_t>& elements) const {
    const ElementBoxes& all = ways_.boxes;
    elements.clear();
    for (std::size_t e = 0; e < rod.count; ++e) {
        const std::size_t i = rod.first + e;
        if (all.lowX[i] <= box.upper.x() && all.highX[i] >= box.lower.x() && all.lowY[i] <= box.upper.y() &&
            all.highY[i] >= box.lower.y())
            elements.push_back(static_cast<std::uint32_t>(e));
    }
}

template <class Test>
void PairSearch::elementPairs(std::size_t a, std::size_t b, Test test) {
    const RodWay& rodA = ways_.rods[a];
    const RodWay& rodB = ways_.rods[b];
    const ElementBoxes& all = ways_.boxes;
    Scratch& s = scratch_;
    near(rodB, rodA.box, s.elements);
    const std::size_t n = s.elements.size();
    if (n == 0)
        return;
    s.boxes.resize(n);
    s.gaps.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        const std::size_t i = rodB.first + s.elements[k];
        s.boxes.lowX[k] = all.lowX[i];
        s.boxes.lowY[k] = all.lowY[i];
        s.boxes.highX[k] = all.highX[i];
        s.boxes.highY[k] = all.highY[i];
    }
    const double *lowX = s.boxes.lowX.data(), *lowY = s.boxes.lowY.data();
    const double *highX = s.boxes.highX.data(), *highY = s.boxes.highY.data();
    double* gaps = s.gaps.data();
    for (std::size_t e = 0; e < rodA.count; ++e) {
        const std::size_t i = rodA.first + e;
        const double x0 = all.lowX[i], y0 = all.lowY[i], x1 = all.highX[i], y1 = all.highY[i];
        if (x0 > rodB.box.upper.x() || x1 < rodB.box.lower.x() || y0 > rodB.box.upper.y() || y1 < rodB.box.lower.y())
            continue;
        for (std::size_t k = 0; k < n; ++k) {
            const double gapX = std::max(lowX[k] - x1, x0 - highX[k]);
            const double gapY = std::max(lowY[k] - y1, y0 - highY[k]);
            gaps[k] = std::max(gapX, gapY);
        }
        for (std::size_t k = 0; k < n; ++k) {
            if (gaps[k] > 0.0 || (a == b && (s.elements[k] <= e || neighbours(e, s.elements[k], curves_[a]))))
                continue;
            piecePairs(a, e, b, s.elements[k], test);
        }
    }
}

template <class Test>
void PairSearch::piecePairs(std::size_t rodA, std::size_t a, std::size_t rodB, std::size_t b, Test test) {
    Pieces& pieces = scratch_.pieces;
    const Pieces::Range first = pieces.of(rodA, a);
    const Pieces::Range second = pieces.of(rodB, b);
    const witness::Motion& motionA = ways_.rods[rodA].motion;
    const witness::Motion& motionB = ways_.rods[rodB].motion;
    const double way = motionA.travel + motionB.travel + 2.0 * (motionA.slack + motionB.slack);
    for (std::size_t i = first.first; i < first.first + first.count; ++i)
        for (std::size_t j = second.first; j < second.first + second.count; ++j) {
            if (witness::separation(pieces.piece(i).before, pieces.piece(j).before) > way)
                continue; // whatever they do, they do not reach each other
            const Moving& one = pieces.completed(i);
            const Moving& other = pieces.completed(j);
            if (one.box.meets(other.box))
                test(one, other);
        }
}

template <class Test>
void PairSearch::outlinePairs(const std::vector<Outline>& outlines, const std::vector<char>& outlineMoves, Test test) {
    std::vector<std::uint32_t>& elements = scratch_.elements;
    Pieces& pieces = scratch_.pieces;
    for (const Moving& m : ways_.outlines) {
        const auto o = static_cast<std::size_t>(m.outline);
        for (std::size_t r = 0; r < ways_.rods.size(); ++r) {
            const RodWay& rod = ways_.rods[r];
            if (rod.count == 0 || !rod.box.meets(m.box) || !filtersAgree(curves_[r], outlines[o]))
                continue;
            if (skipStill_ && rod.still && outlineMoves[o] == 0)
                continue;
            near(rod, m.box, elements);
            for (const std::uint32_t e : elements) {
                const Pieces::Range range = pieces.of(r, e);
                for (std::size_t i = range.first; i < range.first + range.count; ++i)
                    if (pieces.completed(i).box.meets(m.box))
                        test(pieces.piece(i), m);
            }
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
/// Rods at rest and outlines at rest are left out if `skipStill`.
void findInside(const std::vector<Curve>& curves, const Ways& ways, const std::vector<Outline>& outlines,
                const std::vector<char>& outlineMoves, bool skipStill, std::vector<Crossing>& out) {
    for (std::size_t o = 0; o < outlines.size(); ++o) {
        const Outline& outline = outlines[o];
        if (outline.kind == OutlineKind::Segment)
            continue;
        const bool atRest = skipStill && outlineMoves[o] == 0;
        const AlignedBox narrow = boxOf(outline, 0.0);
        for (std::size_t r = 0; r < ways.rods.size(); ++r) {
            const Curve& c = curves[r];
            const RodWay& rod = ways.rods[r];
            const double depth = 2.0 * c.halfThickness;
            AlignedBox box = narrow;
            box.grow(depth);
            if (rod.count == 0 || (atRest && rod.still) || !filtersAgree(c, outline) || !rod.box.meets(box))
                continue;
            const auto report = [&](double s, const Vec2& p) {
                const bool hit = outline.kind == OutlineKind::OneSided ? behind(p, outline, depth) : inside(p, outline);
                if (hit)
                    out.push_back({static_cast<std::int32_t>(r), -1, static_cast<std::int32_t>(o), s, p});
                return hit;
            };
            bool found = false;
            for (std::size_t e = 0; e < c.arcs.size() && !found; ++e) {
                const std::size_t i = rod.first + e;
                const ElementBoxes& all = ways.boxes;
                if (all.lowX[i] > box.upper.x() || all.highX[i] < box.lower.x() || all.lowY[i] > box.upper.y() ||
                    all.highY[i] < box.lower.y())
                    continue;
                const Arc& arc = c.arcs[e];
                const double s = e < c.nodeS.size() ? c.nodeS[e] : 0.0;
                found = report(s, arc.start) || report(s + 0.5 * arc.length, arc.pointAt(0.5 * arc.length));
                if (!found && e + 1 == c.arcs.size())
                    found = report(s + arc.length, arc.pointAt(arc.length));
            }
        }
    }
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

/// Rods whose pairs one thread tests at a time.
constexpr std::size_t kGrain = 24;

/// What is kept from call to call: storage only.
struct Kept {
    Ways ways;
    Sweep sweep;
    std::vector<char> moves;
    parallel::Pool<Scratch> scratch;
    std::vector<std::vector<Crossing>> found;
};
Kept& kept() { // to be called outside of loops: other threads have another one
    static thread_local Kept storage;
    return storage;
}

} // namespace

void findCrossings(const std::vector<Curve>& curves, const std::vector<Outline>& outlines, std::vector<Crossing>& out) {
    out.clear();
    Kept& k = kept();
    k.ways.prepare(curves, curves, outlines, outlines, {});
    k.sweep.prepare(k.ways);
    const parallel::Pool<Scratch>::Loan scratch(k.scratch);
    PairSearch search(k.ways, curves, false, *scratch);
    const std::vector<char> moves(outlines.size(), 0);
    const auto test = [&](const Moving& a, const Moving& b) {
        if (witness::separation(a.before, b.before) > 0.0)
            return;
        std::array<Meeting, 2> meetings;
        const int n = witness::intersect(a.before, b.before, 0.0, meetings);
        for (int i = 0; i < n; ++i) {
            const Meeting& m = meetings[static_cast<std::size_t>(i)];
            out.push_back(crossingOf(a, b, m.sA, m.where));
        }
    };
    search.rodPairs(k.sweep, 0, k.sweep.items.size(), test);
    search.outlinePairs(outlines, moves, test);
    findInside(curves, k.ways, outlines, moves, false, out);
    findOverturned(curves, out);
    keepFirst(out, [&](const Crossing& c) { // a solid is entered once, however often its faces are crossed
        return c.outline >= 0 && outlines[static_cast<std::size_t>(c.outline)].kind != OutlineKind::Segment;
    });
}

void findCrossingsSwept(const std::vector<Curve>& before, const std::vector<Curve>& after,
                        const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                        std::vector<Crossing>& out, const parallel::For& loop) {
    out.clear();
    Kept& k = kept();
    k.ways.prepare(before, after, outlinesBefore, outlinesAfter, loop);
    k.sweep.prepare(k.ways);
    k.moves.clear();
    for (std::size_t o = 0; o < outlinesAfter.size(); ++o)
        k.moves.push_back(o >= outlinesBefore.size() || outlinesBefore[o].points != outlinesAfter[o].points ? 1 : 0);
    const auto into = [](std::vector<Crossing>& found) {
        return [&found](const Moving& a, const Moving& b) {
            Crossing c;
            if (meetOnTheWay(a, b, c))
                found.push_back(c);
        };
    };
    const std::size_t rods = k.sweep.items.size();
    k.found.resize(std::max(k.found.size(), parallel::chunkCount(loop, rods, kGrain)));
    for (std::vector<Crossing>& found : k.found)
        found.clear();
    parallel::forChunks(loop, rods, kGrain, [&](std::size_t c, std::size_t begin, std::size_t end) {
        const parallel::Pool<Scratch>::Loan scratch(k.scratch);
        PairSearch(k.ways, before, true, *scratch).rodPairs(k.sweep, begin, end, into(k.found[c]));
    });
    for (const std::vector<Crossing>& found : k.found)
        out.insert(out.end(), found.begin(), found.end());
    const parallel::Pool<Scratch>::Loan scratch(k.scratch);
    PairSearch(k.ways, before, true, *scratch).outlinePairs(outlinesBefore, k.moves, into(out));
    findInside(after, k.ways, outlinesAfter, k.moves, true, out);
    findOverturned(after, out);
    keepFirst(out, [](const Crossing&) { return true; });
}

} // namespace supercircle::contact
