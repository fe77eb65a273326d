// Elements, wall segments and solid faces become circular arcs. Pairs whose boxes overlap are tested by exact
// intersection. Between two configurations, middles, angles and curvatures of the arcs are interpolated. Even sampling
// of the motion is not enough: two parallel centre lines that pass through each other sideways intersect at one instant
// only. Conservative advancement is used instead (decision 0122): at distance d, nothing can meet before the arcs have
// moved by d relative to each other, so the next sample is taken there. A distance below a thousandth of the thickness
// counts as a crossing. The ends of interpolated arcs are known up to a slack that falls with the square of the step.
// Where it exceeds the thickness nothing can be said, and where it is used up the samples lie a thousandth of the
// thickness apart: such motions are not walked, or not to their end, and the step is cut.
//
// Limits of the check are listed in decision 0122: neighbouring elements, one-sided edges, filters, resting rods. The
// motion of a pair of rods, or of rod and outline, is reported at most once.

#include "supercircle/contact/crossing.h"

#include "supercircle/contact/crossing/points_inside.h"
#include "supercircle/contact/one_sided.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>

namespace supercircle::contact {

namespace {

using crossing_check::AlignedBox;
using crossing_check::CircularArc;
using crossing_check::ElementBoxes;
using crossing_check::findInside;
using crossing_check::Intersection;
using crossing_check::mayTouch;
using crossing_check::MovingArc;
using crossing_check::MovingArcs;
using crossing_check::RodMotion;
using crossing_check::SweptMotion;

bool mayTouchItself(const RodCurve& c) {
    return (c.category & c.mask) != 0;
}

bool neighbours(std::size_t a, std::size_t b, const RodCurve& c) {
    const std::size_t apart = a < b ? b - a : a - b;
    return apart <= 1 || (c.closed && apart + 1 == c.arcs.size());
}

/// Rods sorted by the lower ends of their boxes, along the axis of their widest spread.
struct SortedRods {
    struct Item {
        double low, high;
        std::uint32_t rod;
        bool operator<(const Item& o) const { return low != o.low ? low < o.low : rod < o.rod; }
    };
    std::vector<Item> items;
    int across = 1; ///< the other axis

    void prepare(const SweptMotion& motion);
};

/// Workspace of one search; storage is kept.
struct Scratch {
    MovingArcs arcs;
    std::vector<std::uint32_t> elements;
    ElementBoxes boxes;
    std::vector<double> gaps;
};

/// The search for pairs whose boxes overlap: rods along the sorted axis, their elements all against all.
class PairSearch {
public:
    PairSearch(const SweptMotion& motion, const std::vector<RodCurve>& curves, bool skipStill, Scratch& scratch)
        : motion_(motion), curves_(curves), skipStill_(skipStill), scratch_(scratch) {
        scratch_.arcs.begin(motion);
    }

    /// Calls test(a, b) for all pairs of a rod of [begin, end) in sorted order with itself and the rods after it. The
    /// order depends on geometry only.
    template <class Test>
    void rodPairs(const SortedRods& sorted, std::size_t begin, std::size_t end, Test test);
    /// The same with outlines (as b). `outlineMoves[o]`: the outline moves; a rod at rest is tested against those only.
    template <class Test>
    void outlinePairs(const std::vector<Outline>& outlines, const std::vector<char>& outlineMoves, Test test);

private:
    /// Collects the elements of a rod whose boxes overlap `box`.
    void near(const RodMotion& rod, const AlignedBox& box, std::vector<std::uint32_t>& elements) const;
    template <class Test>
    void elementPairs(std::size_t a, std::size_t b, Test test);
    template <class Test>
    void arcPairs(std::size_t rodA, std::size_t a, std::size_t rodB, std::size_t b, Test test);

    const SweptMotion& motion_;
    const std::vector<RodCurve>& curves_;
    bool skipStill_;
    Scratch& scratch_;
};

void SortedRods::prepare(const SweptMotion& motion) {
    Vec2 spread = Vec2::Zero(), sizes = Vec2::Zero();
    AlignedBox all;
    for (const RodMotion& rod : motion.rods) {
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
    for (std::size_t r = 0; r < motion.rods.size(); ++r) {
        const RodMotion& rod = motion.rods[r];
        if (rod.count > 0)
            items.push_back({rod.box.lower[axis], rod.box.upper[axis], static_cast<std::uint32_t>(r)});
    }
    std::sort(items.begin(), items.end());
}

template <class Test>
void PairSearch::rodPairs(const SortedRods& sorted, std::size_t begin, std::size_t end, Test test) {
    const std::vector<SortedRods::Item>& items = sorted.items;
    const int across = sorted.across;
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t a = items[i].rod;
        const RodMotion& rodA = motion_.rods[a];
        const bool still = skipStill_ && rodA.still;
        if (!still && mayTouchItself(curves_[a]))
            elementPairs(a, a, test);
        for (std::size_t j = i + 1; j < items.size() && items[j].low <= items[i].high; ++j) {
            const std::size_t b = items[j].rod;
            const RodMotion& rodB = motion_.rods[b];
            if (rodB.box.lower[across] > rodA.box.upper[across] || rodB.box.upper[across] < rodA.box.lower[across])
                continue;
            if ((still && rodB.still) || !mayTouch(curves_[a], curves_[b]))
                continue;
            elementPairs(std::min(a, b), std::max(a, b), test);
        }
    }
}

void PairSearch::near(const RodMotion& rod, const AlignedBox& box, std::vector<std::uint32_t>& elements) const {
    const ElementBoxes& all = motion_.boxes;
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
    const RodMotion& rodA = motion_.rods[a];
    const RodMotion& rodB = motion_.rods[b];
    const ElementBoxes& all = motion_.boxes;
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
            arcPairs(a, e, b, s.elements[k], test);
        }
    }
}

template <class Test>
void PairSearch::arcPairs(std::size_t rodA, std::size_t a, std::size_t rodB, std::size_t b, Test test) {
    MovingArcs& arcs = scratch_.arcs;
    const MovingArcs::ArcRange first = arcs.arcsOf(rodA, a);
    const MovingArcs::ArcRange second = arcs.arcsOf(rodB, b);
    const crossing_check::MotionBound& boundA = motion_.rods[rodA].bound;
    const crossing_check::MotionBound& boundB = motion_.rods[rodB].bound;
    const double path = boundA.path + boundB.path + 2.0 * (boundA.endMismatch + boundB.endMismatch);
    for (std::size_t i = first.first; i < first.first + first.count; ++i)
        for (std::size_t j = second.first; j < second.first + second.count; ++j) {
            if (crossing_check::separation(arcs.arc(i).before, arcs.arc(j).before) > path)
                continue; // they cannot reach each other
            const MovingArc& one = arcs.completed(i);
            const MovingArc& other = arcs.completed(j);
            if (one.box.overlaps(other.box))
                test(one, other);
        }
}

template <class Test>
void PairSearch::outlinePairs(const std::vector<Outline>& outlines, const std::vector<char>& outlineMoves, Test test) {
    std::vector<std::uint32_t>& elements = scratch_.elements;
    MovingArcs& arcs = scratch_.arcs;
    for (const MovingArc& m : motion_.outlines) {
        const auto o = static_cast<std::size_t>(m.outline);
        for (std::size_t r = 0; r < motion_.rods.size(); ++r) {
            const RodMotion& rod = motion_.rods[r];
            if (rod.count == 0 || !rod.box.overlaps(m.box) || !mayTouch(curves_[r], outlines[o]))
                continue;
            if (skipStill_ && rod.still && outlineMoves[o] == 0)
                continue;
            near(rod, m.box, elements);
            for (const std::uint32_t e : elements) {
                const MovingArcs::ArcRange range = arcs.arcsOf(r, e);
                for (std::size_t i = range.first; i < range.first + range.count; ++i)
                    if (arcs.completed(i).box.overlaps(m.box))
                        test(arcs.arc(i), m);
            }
        }
    }
}

Crossing crossingOf(const MovingArc& a, const MovingArc& b, double s, const Vec2& where) {
    Crossing c;
    c.rodA = a.rod;
    c.rodB = b.rod;
    c.outline = b.outline;
    c.sA = a.s0 + s;
    c.where = where;
    return c;
}

/// Most samples of a pair. A pair in contact at a twentieth of the thickness of slack takes a few. Half of it cuts
/// more steps of shells that whip against each other; twice as much lets such a step cost twice as much.
constexpr int kMostSamples = 400;

/// Outlines before and after a motion.
struct OutlineMotion {
    const std::vector<Outline>& before;
    const std::vector<Outline>& after;
    [[nodiscard]] bool isOneSided(std::int32_t o) const {
        return o >= 0 && before[static_cast<std::size_t>(o)].kind == OutlineKind::OneSided;
    }
};

/// Whether a joint of a chain is a corner, which belongs to the edge that starts there.
bool startsAtRidge(const Outline& edge) {
    const Vec2 before = edge.points[0] - edge.neighbourStart, along = edge.points[1] - edge.points[0];
    constexpr double kTurn = 1e-6; // sine of the angle; as detection's
    return rod::cross(before, along) < -kTurn * before.norm() * along.norm();
}

/// Whether a rod is in front of a one-sided edge where it is beside a place of it, x m from the edge's middle. As for
/// contact, the nearest point of the rod decides: past a free end of the edge it may be another one than comes there.
/// Past a joined end the neighbour's front counts; if there is none, the end is open as in Box2D.
bool isInFrontAt(const CircularArc& rod, const CircularArc& edge, double x, double near, const Outline& outline) {
    const Vec2 place = edge.at(x), q = place - rod.mid;
    const double along = q.dot(rod.tangent), c = 1.0 - rod.curvature * rod::cross(rod.tangent, q);
    const double s = rod.curvature != 0.0 ? math::atan2(rod.curvature * along, c) / rod.curvature : along;
    const Vec2 p = rod.at(std::clamp(s, -rod.half, rod.half));
    const double past = (p - place).dot(edge.tangent);
    if (past < 0.0 && x <= near - edge.half && outline.joinedStart && !startsAtRidge(outline))
        return false;
    if (past > 0.0 && x >= edge.half - near && outline.joinedEnd)
        return false;
    return isInFront(p, outline);
}

double placeOn(const CircularArc& edge, const Vec2& p) {
    return std::clamp((p - edge.mid).dot(edge.tangent), -edge.half, edge.half);
}

/// The place of an edge that is nearest to a rod, if both ends, the middle of the rod or an end of the edge are.
double nearestPlace(const CircularArc& rod, const CircularArc& edge) {
    double nearest = INFINITY, place = 0.0;
    for (const double x :
         {-edge.half, edge.half, placeOn(edge, rod.start), placeOn(edge, rod.mid), placeOn(edge, rod.end)})
        if (const double d = crossing_check::distance(edge.at(x), rod); d < nearest) {
            nearest = d;
            place = x;
        }
    return place;
}

/// Follows the motion of a pair, both ends included. True if the centre lines intersect; `out` says where. At one-sided
/// edges only if they do so at the start, or if what intersects comes from the front.
bool intersectDuringMotion(const MovingArc& a, const MovingArc& b, const OutlineMotion& outlines, CheckEffort& effort,
                           Crossing& out) {
    const bool oneSided = outlines.isOneSided(b.outline);
    const double near = std::max(1e-3 * (a.halfThickness + b.halfThickness), 1e-9 * (a.before.half + b.before.half));
    const auto comesFromFront = [&](double x) {
        return isInFrontAt(a.before, b.before, x, near, outlines.before[static_cast<std::size_t>(b.outline)]);
    };
    const auto goesToBack = [&](double x) {
        return comesFromFront(x) &&
               !isInFrontAt(a.at(1.0), b.at(1.0), x, near, outlines.after[static_cast<std::size_t>(b.outline)]);
    };
    const double path = (a.shift - b.shift).norm() + a.pathBound + b.pathBound;
    const double slack = a.endMismatch + b.endMismatch;
    effort.pairs += 1.0;
    if (crossing_check::separation(a.before, b.before) > path + 2.0 * slack)
        return false;
    const auto leaveOut = [&] {
        effort.unjudged.push_back(crossingOf(a, b, 0.0, a.before.mid));
        return false;
    };
    if (effort.bounded && slack > a.halfThickness + b.halfThickness)
        return leaveOut();
    double lambda = 0.0;
    for (int sample = 0; !effort.bounded || sample < kMostSamples; ++sample) {
        effort.samples += 1.0;
        const CircularArc pa = lambda == 0.0 ? a.before : a.at(lambda);
        const CircularArc pb = lambda == 0.0 ? b.before : b.at(lambda);
        const double extra = lambda == 0.0 || lambda == 1.0 ? 0.0 : slack;
        std::array<Intersection, 2> intersections;
        if (crossing_check::intersect(pa, pb, extra, intersections) > 0) {
            out = crossingOf(a, b, intersections[0].sA, intersections[0].where);
            return !oneSided || lambda == 0.0 || comesFromFront(placeOn(pb, intersections[0].where));
        }
        const double d = crossing_check::distance(pa, pb);
        if (d < near && path > 0.0 && (!oneSided || goesToBack(nearestPlace(pa, pb)))) {
            out = crossingOf(a, b, 0.0, pa.mid);
            return true;
        }
        SC_ASSERT_EXPENSIVE(!(d < 0.0) && !(path < 0.0) && !(slack < 0.0), "distances are not negative");
        const double clear = d - 2.0 * slack;
        if (lambda >= 1.0 || !(clear < path * (1.0 - lambda))) // also ends for a motion that is not a number
            return false;
        lambda = std::min(1.0, lambda + std::max(clear, near) / path);
    }
    return leaveOut();
}

void findFullTurns(const std::vector<RodCurve>& curves, std::vector<Crossing>& out) {
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

/// Keeps the first crossing of each pair for which `once` is true.
template <class Once>
void keepFirst(std::vector<Crossing>& out, Once once) {
    sortCrossings(out);
    out.erase(std::unique(out.begin(), out.end(),
                          [&](const Crossing& a, const Crossing& b) { return pairOf(a) == pairOf(b) && once(a); }),
              out.end());
}

/// Rods whose pairs one thread tests at a time.
constexpr std::size_t kGrain = 24;

/// Storage that is kept from call to call.
struct Workspace {
    SweptMotion motion;
    SortedRods sorted;
    std::vector<char> moves;
    parallel::Pool<Scratch> scratch;
    std::vector<std::vector<Crossing>> found;
    std::vector<CheckEffort> efforts;
};
Workspace& workspace() { // call it outside of parallel loops: every thread has its own
    static thread_local Workspace storage;
    return storage;
}

} // namespace

void findCrossings(const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines,
                   std::vector<Crossing>& out) {
    out.clear();
    Workspace& k = workspace();
    k.motion.prepare(curves, curves, outlines, outlines, {});
    k.sorted.prepare(k.motion);
    const parallel::Pool<Scratch>::Lease scratch(k.scratch);
    PairSearch search(k.motion, curves, false, *scratch);
    const std::vector<char> moves(outlines.size(), 0);
    const auto test = [&](const MovingArc& a, const MovingArc& b) {
        if (crossing_check::separation(a.before, b.before) > 0.0)
            return;
        std::array<Intersection, 2> intersections;
        const int n = crossing_check::intersect(a.before, b.before, 0.0, intersections);
        for (int i = 0; i < n; ++i) {
            const Intersection& m = intersections[static_cast<std::size_t>(i)];
            out.push_back(crossingOf(a, b, m.sA, m.where));
        }
    };
    search.rodPairs(k.sorted, 0, k.sorted.items.size(), test);
    search.outlinePairs(outlines, moves, test);
    findInside(curves, k.motion, outlines, outlines, moves, false, out);
    findFullTurns(curves, out);
    keepFirst(out, [&](const Crossing& c) { // entering a solid counts once, even if several faces are crossed
        return c.outline >= 0 && outlines[static_cast<std::size_t>(c.outline)].kind != OutlineKind::Segment;
    });
}

void findCrossingsSwept(const std::vector<RodCurve>& before, const std::vector<RodCurve>& after,
                        const std::vector<Outline>& outlinesBefore, const std::vector<Outline>& outlinesAfter,
                        std::vector<Crossing>& out, const parallel::For& loop, CheckEffort* effort) {
    out.clear();
    CheckEffort own;
    CheckEffort& all = effort != nullptr ? *effort : own;
    Workspace& k = workspace();
    k.motion.prepare(before, after, outlinesBefore, outlinesAfter, loop);
    k.sorted.prepare(k.motion);
    k.moves.clear();
    for (std::size_t o = 0; o < outlinesAfter.size(); ++o)
        k.moves.push_back(o >= outlinesBefore.size() || outlinesBefore[o].points != outlinesAfter[o].points ? 1 : 0);
    // Whether the work exceeds its limit does not depend on the threads: a part that exceeds it alone ends early, and
    // the sum does then as well.
    const OutlineMotion outlines{outlinesBefore, outlinesAfter};
    const auto into = [&outlines](std::vector<Crossing>& found, CheckEffort& mine) {
        return [&outlines, &found, &mine](const MovingArc& a, const MovingArc& b) {
            Crossing c;
            if (!mine.unfinished() && intersectDuringMotion(a, b, outlines, mine, c))
                found.push_back(c);
        };
    };
    const std::size_t rods = k.sorted.items.size();
    k.found.resize(std::max(k.found.size(), parallel::chunkCount(loop, rods, kGrain)));
    for (std::vector<Crossing>& found : k.found)
        found.clear();
    k.efforts.assign(k.found.size(), {.maxWork = all.maxWork, .bounded = all.bounded});
    parallel::forChunks(loop, rods, kGrain, [&](std::size_t c, std::size_t begin, std::size_t end) {
        const parallel::Pool<Scratch>::Lease scratch(k.scratch);
        PairSearch(k.motion, before, true, *scratch).rodPairs(k.sorted, begin, end, into(k.found[c], k.efforts[c]));
    });
    for (const std::vector<Crossing>& found : k.found)
        out.insert(out.end(), found.begin(), found.end());
    for (const CheckEffort& e : k.efforts)
        all.add(e);
    const parallel::Pool<Scratch>::Lease scratch(k.scratch);
    PairSearch(k.motion, before, true, *scratch).outlinePairs(outlinesBefore, k.moves, into(out, all));
    findInside(after, k.motion, outlinesBefore, outlinesAfter, k.moves, true, out);
    findFullTurns(after, out);
    keepFirst(out, [](const Crossing&) { return true; });
    for (const Crossing& c : out) {
        SC_ASSERT(invariants::inRange(c.rodA, after.size()) && c.rodB < static_cast<std::int32_t>(after.size()),
                  "a crossing names rods of this call");
        SC_ASSERT((c.rodB < 0) == (c.outline >= 0) && c.outline < static_cast<std::int32_t>(outlinesAfter.size()),
                  "a crossing is with a rod or with an outline");
    }
    SC_ASSERT(invariants::strictlyRising(out, [](const Crossing& c) { return pairOf(c); }),
              "a pair is reported once, in rising order");
}

} // namespace supercircle::contact
