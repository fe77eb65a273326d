#include "supercircle/contact/detection/snapshot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::contact {

namespace {

double pointToChord(const Vec2& p, const PieceBound& piece) {
    const Vec2 e = piece.p1 - piece.p0;
    const Vec2 w = p - piece.p0;
    const double l2 = e.squaredNorm();
    const double u = l2 > 0.0 ? std::min(std::max(w.dot(e) / l2, 0.0), 1.0) : 0.0;
    return (w - u * e).norm();
}

double chordToChord(const PieceBound& a, const PieceBound& b) {
    const Vec2 ea = a.p1 - a.p0;
    const Vec2 eb = b.p1 - b.p0;
    const bool crossA = (rod::cross(ea, b.p0 - a.p0) > 0.0) != (rod::cross(ea, b.p1 - a.p0) > 0.0);
    const bool crossB = (rod::cross(eb, a.p0 - b.p0) > 0.0) != (rod::cross(eb, a.p1 - b.p0) > 0.0);
    if (crossA && crossB)
        return 0.0;
    return std::min(std::min(pointToChord(a.p0, b), pointToChord(a.p1, b)),
                    std::min(pointToChord(b.p0, a), pointToChord(b.p1, a)));
}

bool near(const PieceBound& a, const PieceBound& b, double reach) {
    const double r = a.radius + b.radius + reach;
    if ((a.middle - b.middle).squaredNorm() > r * r)
        return false;
    return chordToChord(a, b) <= a.sagitta + b.sagitta + reach;
}

bool near(const Vec2& p, const PieceBound& piece, double reach) {
    const double r = piece.radius + reach;
    if ((p - piece.middle).squaredNorm() > r * r)
        return false;
    return pointToChord(p, piece) <= piece.sagitta + reach;
}

bool inside(const Vec2& p, const Box& box) {
    return p.x() >= box.low.x() && p.x() <= box.high.x() && p.y() >= box.low.y() && p.y() <= box.high.y();
}

bool touches(const PieceBound& piece, const Box& box) {
    return piece.middle.x() + piece.radius >= box.low.x() && piece.middle.x() - piece.radius <= box.high.x() &&
           piece.middle.y() + piece.radius >= box.low.y() && piece.middle.y() - piece.radius <= box.high.y();
}

Check makeCheck(std::size_t i, std::size_t j) {
    return {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)};
}

void collectSamples(const RodSnapshot& sampled, const RodSnapshot& other, double reach, std::vector<Check>& out) {
    const Box box = other.box.grown(reach);
    for (std::size_t i = 0; i < sampled.samples.size(); ++i) {
        if (!inside(sampled.samples[i], box))
            continue;
        for (std::size_t j = 0; j < other.pieces.size(); ++j)
            if (near(sampled.samples[i], other.pieces[j], reach))
                out.push_back(makeCheck(i, j));
    }
}

} // namespace

void takeSnapshot(const RodShape& rod, RodSnapshot& snapshot) {
    snapshot.pieces.clear();
    snapshot.tangents.clear();
    snapshot.samples.clear();
    snapshot.lengths.clear();
    snapshot.starts.clear();
    snapshot.sampleS.clear();
    snapshot.box = Box{};
    for (const Piece& piece : rod.pieces) {
        PieceBound bound;
        bound.p0 = piece.p0;
        bound.p1 = piece.p1;
        const Vec2 chord = piece.p1 - piece.p0;
        const double length = chord.norm();
        const Vec2 c = chord / length;
        // Half the angle between tangent and chord is a quarter of the turn.
        const double quarter = rod::cross(piece.t0, c) / (1.0 + piece.t0.dot(c));
        bound.sagitta = 0.5 * length * std::abs(quarter);
        bound.middle = 0.5 * (piece.p0 + piece.p1) - 0.5 * length * quarter * rod::perp(c);
        bound.radius = (bound.middle - piece.p0).norm() * (1.0 + 1e-12);
        snapshot.box.include(piece.p0, bound.sagitta);
        snapshot.box.include(piece.p1, bound.sagitta);
        snapshot.pieces.push_back(bound);
        snapshot.tangents.push_back(piece.t0);
        snapshot.lengths.push_back(piece.length);
        snapshot.starts.push_back(piece.s0);
    }
    snapshot.tangents.push_back(rod.pieces.back().t1);
    for (const Sample& sample : rod.samples) {
        snapshot.samples.push_back(sample.p);
        snapshot.sampleS.push_back(sample.s);
    }
    const auto [low, high] = std::minmax_element(rod.turn.begin(), rod.turn.end());
    snapshot.totalTurn = *high - *low;
}

double displacement(const RodShape& rod, const RodSnapshot& snapshot) {
    const double never = std::numeric_limits<double>::infinity();
    if (rod.pieces.size() != snapshot.pieces.size() || rod.samples.size() != snapshot.samples.size())
        return never;
    double moved = 0.0;
    double turned = 0.0;
    double longest = 0.0;
    for (std::size_t i = 0; i < rod.pieces.size(); ++i) {
        const Piece& piece = rod.pieces[i];
        if (piece.length != snapshot.lengths[i])
            return never;
        moved = std::max(moved, (piece.p0 - snapshot.pieces[i].p0).squaredNorm());
        turned = std::max(turned, (piece.t0 - snapshot.tangents[i]).squaredNorm());
        longest = std::max(longest, piece.length);
    }
    moved = std::max(moved, (rod.pieces.back().p1 - snapshot.pieces.back().p1).squaredNorm());
    turned = std::max(turned, (rod.pieces.back().t1 - snapshot.tangents.back()).squaredNorm());
    return std::sqrt(moved) + 0.4 * longest * std::sqrt(turned);
}

void collectChecks(const RodSnapshot& a, const RodSnapshot& b, double reach, RodPairChecks& checks) {
    checks.samplesOfA.clear();
    checks.samplesOfB.clear();
    checks.pieces.clear();
    collectSamples(a, b, reach, checks.samplesOfA);
    collectSamples(b, a, reach, checks.samplesOfB);
    const Box box = b.box.grown(reach);
    for (std::size_t i = 0; i < a.pieces.size(); ++i) {
        if (!touches(a.pieces[i], box))
            continue;
        for (std::size_t j = 0; j < b.pieces.size(); ++j)
            if (near(a.pieces[i], b.pieces[j], reach))
                checks.pieces.push_back(makeCheck(i, j));
    }
}

void collectSelfChecks(const RodSnapshot& rod, double reach, RodPairChecks& checks) {
    checks.samplesOfA.clear();
    checks.samplesOfB.clear();
    checks.pieces.clear();
    for (std::size_t i = 0; i < rod.samples.size(); ++i) {
        const double s = rod.sampleS[i];
        for (std::size_t j = 0; j < rod.pieces.size(); ++j) {
            // A piece turns by a quarter at most: never a different stretch from its own points.
            const double slack = 1e-6 * rod.lengths[j];
            if (s >= rod.starts[j] - slack && s <= rod.starts[j] + rod.lengths[j] + slack)
                continue;
            if (near(rod.samples[i], rod.pieces[j], reach))
                checks.samplesOfA.push_back(makeCheck(i, j));
        }
    }
    for (std::size_t i = 0; i < rod.pieces.size(); ++i)
        for (std::size_t j = i + 2; j < rod.pieces.size(); ++j)
            if (near(rod.pieces[i], rod.pieces[j], reach))
                checks.pieces.push_back(makeCheck(i, j));
}

void collectChecks(const RodSnapshot& rod, const OutlineShape& outline, double reach, OutlinePairChecks& checks) {
    checks.samples.clear();
    checks.pieces.clear();
    checks.corners.clear();
    for (std::size_t i = 0; i < rod.samples.size(); ++i)
        if (distanceBound(outline, rod.samples[i]) <= reach)
            checks.samples.push_back(static_cast<std::uint16_t>(i));
    for (std::size_t j = 0; j < rod.pieces.size(); ++j)
        if (distanceBound(outline, rod.pieces[j].middle) <= reach + rod.pieces[j].radius)
            checks.pieces.push_back(static_cast<std::uint16_t>(j));
    for (std::size_t c = 0; c < outline.corners.size(); ++c)
        for (const std::uint16_t j : checks.pieces)
            if (near(outline.corners[c].p, rod.pieces[j], reach + outline.radius))
                checks.corners.push_back(makeCheck(c, j));
}

Box boxOf(const OutlineShape& outline, const OutlinePoints& points) {
    Box box;
    for (const Vec2& p : points)
        box.include(p, outline.radius);
    return box;
}

} // namespace supercircle::contact
