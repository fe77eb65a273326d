#include "supercircle/contact/detection/reference_shape.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::contact {

namespace {

double pointToChord(const Vec2& p, const SubArcBound& arc) {
    const Vec2 e = arc.p1 - arc.p0;
    const Vec2 w = p - arc.p0;
    const double l2 = e.squaredNorm();
    const double u = l2 > 0.0 ? std::min(std::max(w.dot(e) / l2, 0.0), 1.0) : 0.0;
    return (w - u * e).norm();
}

double chordToChord(const SubArcBound& a, const SubArcBound& b) {
    const Vec2 ea = a.p1 - a.p0;
    const Vec2 eb = b.p1 - b.p0;
    const bool crossA = (rod::cross(ea, b.p0 - a.p0) > 0.0) != (rod::cross(ea, b.p1 - a.p0) > 0.0);
    const bool crossB = (rod::cross(eb, a.p0 - b.p0) > 0.0) != (rod::cross(eb, a.p1 - b.p0) > 0.0);
    if (crossA && crossB)
        return 0.0;
    return std::min(std::min(pointToChord(a.p0, b), pointToChord(a.p1, b)),
                    std::min(pointToChord(b.p0, a), pointToChord(b.p1, a)));
}

bool near(const SubArcBound& a, const SubArcBound& b, double reach) {
    const double r = a.radius + b.radius + reach;
    if ((a.middle - b.middle).squaredNorm() > r * r)
        return false;
    return chordToChord(a, b) <= a.sagitta + b.sagitta + reach;
}

bool near(const Vec2& p, const SubArcBound& arc, double reach) {
    const double r = arc.radius + reach;
    if ((p - arc.middle).squaredNorm() > r * r)
        return false;
    return pointToChord(p, arc) <= arc.sagitta + reach;
}

bool inside(const Vec2& p, const Box& box) {
    return p.x() >= box.low.x() && p.x() <= box.high.x() && p.y() >= box.low.y() && p.y() <= box.high.y();
}

bool touches(const SubArcBound& arc, const Box& box) {
    return arc.middle.x() + arc.radius >= box.low.x() && arc.middle.x() - arc.radius <= box.high.x() &&
           arc.middle.y() + arc.radius >= box.low.y() && arc.middle.y() - arc.radius <= box.high.y();
}

Check makeCheck(std::size_t i, std::size_t j) {
    return {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j)};
}

void collectSamples(const ReferenceShape& sampled, const ReferenceShape& other, double reach, std::vector<Check>& out) {
    const Box box = other.box.enlarged(reach);
    for (std::size_t i = 0; i < sampled.samples.size(); ++i) {
        if (!inside(sampled.samples[i], box))
            continue;
        for (std::size_t j = 0; j < other.subArcs.size(); ++j)
            if (near(sampled.samples[i], other.subArcs[j], reach))
                out.push_back(makeCheck(i, j));
    }
}

} // namespace

void setReference(const RodShape& rod, ReferenceShape& reference) {
    reference.subArcs.clear();
    reference.tangents.clear();
    reference.samples.clear();
    reference.lengths.clear();
    reference.starts.clear();
    reference.sampleS.clear();
    reference.box = Box{};
    for (const SubArc& arc : rod.subArcs) {
        SubArcBound bound;
        bound.p0 = arc.p0;
        bound.p1 = arc.p1;
        const Vec2 chord = arc.p1 - arc.p0;
        const double length = chord.norm();
        const Vec2 c = chord / length;
        // Half the angle between tangent and chord is a quarter of the rotation of the tangent.
        const double quarter = rod::cross(arc.t0, c) / (1.0 + arc.t0.dot(c));
        bound.sagitta = 0.5 * length * std::abs(quarter);
        bound.middle = 0.5 * (arc.p0 + arc.p1) - 0.5 * length * quarter * rod::perp(c);
        bound.radius = (bound.middle - arc.p0).norm() * (1.0 + 1e-12);
        reference.box.include(arc.p0, bound.sagitta);
        reference.box.include(arc.p1, bound.sagitta);
        reference.subArcs.push_back(bound);
        reference.tangents.push_back(arc.t0);
        reference.lengths.push_back(arc.length);
        reference.starts.push_back(arc.s0);
    }
    reference.tangents.push_back(rod.subArcs.back().t1);
    for (const Sample& sample : rod.samples) {
        reference.samples.push_back(sample.p);
        reference.sampleS.push_back(sample.s);
    }
    const auto [low, high] = std::minmax_element(rod.turn.begin(), rod.turn.end());
    reference.totalTurn = *high - *low;
    SC_ASSERT(reference.tangents.size() == reference.subArcs.size() + 1, "one tangent at each end of a sub-arc");
    SC_ASSERT(reference.samples.size() <= 0xffff && reference.subArcs.size() <= 0xffff, "checks index in 16 bits");
    SC_ASSERT(!(reference.totalTurn < 0.0), "a range is not negative");
}

double displacement(const RodShape& rod, const ReferenceShape& reference) {
    const double never = std::numeric_limits<double>::infinity();
    if (rod.subArcs.size() != reference.subArcs.size() || rod.samples.size() != reference.samples.size())
        return never;
    double moved = 0.0;
    double turned = 0.0;
    double longest = 0.0;
    for (std::size_t i = 0; i < rod.subArcs.size(); ++i) {
        const SubArc& arc = rod.subArcs[i];
        if (arc.length != reference.lengths[i])
            return never;
        moved = std::max(moved, (arc.p0 - reference.subArcs[i].p0).squaredNorm());
        turned = std::max(turned, (arc.t0 - reference.tangents[i]).squaredNorm());
        longest = std::max(longest, arc.length);
    }
    moved = std::max(moved, (rod.subArcs.back().p1 - reference.subArcs.back().p1).squaredNorm());
    turned = std::max(turned, (rod.subArcs.back().t1 - reference.tangents.back()).squaredNorm());
    return std::sqrt(moved) + 0.4 * longest * std::sqrt(turned);
}

void collectChecks(const ReferenceShape& a, const ReferenceShape& b, double reach, RodPairChecks& checks) {
    checks.samplesOfA.clear();
    checks.samplesOfB.clear();
    checks.subArcs.clear();
    collectSamples(a, b, reach, checks.samplesOfA);
    collectSamples(b, a, reach, checks.samplesOfB);
    const Box box = b.box.enlarged(reach);
    for (std::size_t i = 0; i < a.subArcs.size(); ++i) {
        if (!touches(a.subArcs[i], box))
            continue;
        for (std::size_t j = 0; j < b.subArcs.size(); ++j)
            if (near(a.subArcs[i], b.subArcs[j], reach))
                checks.subArcs.push_back(makeCheck(i, j));
    }
}

void collectSelfChecks(const ReferenceShape& rod, double reach, RodPairChecks& checks) {
    checks.samplesOfA.clear();
    checks.samplesOfB.clear();
    checks.subArcs.clear();
    for (std::size_t i = 0; i < rod.samples.size(); ++i) {
        const double s = rod.sampleS[i];
        for (std::size_t j = 0; j < rod.subArcs.size(); ++j) {
            // A sub-arc rotates by a quarter turn at most: its own points are never a different part of the rod.
            const double slack = 1e-6 * rod.lengths[j];
            if (s >= rod.starts[j] - slack && s <= rod.starts[j] + rod.lengths[j] + slack)
                continue;
            if (near(rod.samples[i], rod.subArcs[j], reach))
                checks.samplesOfA.push_back(makeCheck(i, j));
        }
    }
    for (std::size_t i = 0; i < rod.subArcs.size(); ++i)
        for (std::size_t j = i + 2; j < rod.subArcs.size(); ++j)
            if (near(rod.subArcs[i], rod.subArcs[j], reach))
                checks.subArcs.push_back(makeCheck(i, j));
}

void collectChecks(const ReferenceShape& rod, const OutlineShape& outline, double reach, OutlinePairChecks& checks) {
    checks.samples.clear();
    checks.subArcs.clear();
    checks.corners.clear();
    for (std::size_t i = 0; i < rod.samples.size(); ++i)
        if (distanceBound(outline, rod.samples[i]) <= reach)
            checks.samples.push_back(static_cast<std::uint16_t>(i));
    for (std::size_t j = 0; j < rod.subArcs.size(); ++j)
        if (distanceBound(outline, rod.subArcs[j].middle) <= reach + rod.subArcs[j].radius)
            checks.subArcs.push_back(static_cast<std::uint16_t>(j));
    for (std::size_t c = 0; c < outline.corners.size(); ++c)
        for (const std::uint16_t j : checks.subArcs)
            if (near(outline.corners[c].p, rod.subArcs[j], reach + outline.radius))
                checks.corners.push_back(makeCheck(c, j));
}

Box boxOf(const OutlineShape& outline, const OutlinePoints& points) {
    Box box;
    for (const Vec2& p : points)
        box.include(p, outline.radius);
    return box;
}

} // namespace supercircle::contact
