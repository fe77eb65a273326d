#include "supercircle/contact/detection/rod_pair.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::contact {

namespace {

constexpr double kRightAngle = 1.5707963267948966;

struct AngleRange {
    double low, high;
    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

/// Adds the angles of the tangent on [from, to].
void includeTurn(const RodShape& rod, double from, double to, double offset, AngleRange& range) {
    for (std::size_t i = 0; i < rod.subArcs.size(); ++i) {
        const SubArc& arc = rod.subArcs[i];
        if (arc.s0 + arc.length < from || arc.s0 > to)
            continue;
        const double begin = std::max(from - arc.s0, 0.0);
        const double end = std::min(to - arc.s0, arc.length);
        range.include(offset + rod.turn[i] + arc.curvature * begin);
        range.include(offset + rod.turn[i] + arc.curvature * end);
    }
}

struct RodEvaluation {
    const RodSide& a;
    const RodSide& b;
    double distance; ///< of centre lines, up to which candidates count, m
    double tolerance;
    CandidateReducer& reducer;
};

/// True if s is a sample of the rod, to round-off.
bool atSample(const RodShape& rod, const SubArc& arc, double s, double tolerance) {
    return s <= tolerance || arc.length - s <= tolerance || std::abs(arc.s0 + s - rod.midS) <= tolerance;
}

/// Arc length that identifies a point: at the weld of a closed rod both ends are the same point.
double canonicalS(const RodShape& rod, double s, double tolerance) {
    return rod.closed && rod.endS - s <= tolerance ? s - rod.length : s;
}

void addSample(const RodEvaluation& e, const RodSide& sampled, const RodSide& other, Candidate& c, const Sample& sample,
               bool left, bool shared) {
    c.a = {sampled.rod, sample.element, sample.s};
    c.id = makeId(sampled.key, other.key, Feature::SampleRod, samplePayload(sample.index, left, 0));
    double u = canonicalS(*sampled.shape, c.a.s, e.tolerance);
    double v = canonicalS(*other.shape, c.b.s, e.tolerance);
    if (sampled.rod == other.rod ? v < u : sampled.rod != e.a.rod)
        std::swap(u, v);
    e.reducer.addRanked(c, u, v, 0.0, shared);
}

/// Two tips make one candidate, with the smaller key (or the earlier tip) as side A.
void addTipTip(const RodEvaluation& e, const RodSide& sampled, const RodSide& other, Candidate& c, const Sample& sample,
               const EndHit& hit, const Vec2& end) {
    const bool swap = sampled.rod == other.rod ? c.b.s < sample.s : sampled.rod != e.a.rod;
    const RodPoint first{sampled.rod, sample.element, sample.s};
    const double hSampled = sampled.shape->halfThickness;
    const double hOther = other.shape->halfThickness;
    if (swap) {
        c.a = c.b;
        c.b = first;
        setRodFrame(c, end, hOther, sample.p, hSampled, -hit.normal, hit.distance);
    } else {
        c.a = first;
        setRodFrame(c, sample.p, hSampled, end, hOther, hit.normal, hit.distance);
    }
    const RodSide& sideA = swap ? other : sampled;
    const RodSide& sideB = swap ? sampled : other;
    const std::uint32_t tipA = c.a.s > sideA.shape->subArcs.front().s0 ? 1U : 0U;
    const std::uint32_t tipB = c.b.s > sideB.shape->subArcs.front().s0 ? 1U : 0U;
    c.id = makeId(sideA.key, sideB.key, Feature::TipTip, 2U * tipA + tipB);
    e.reducer.add(c, c.a.s, c.b.s, 0.0, true);
}

/// A sample beyond the end of the other rod, against its round cap.
void sampleOnEnd(const RodEvaluation& e, const RodSide& sampled, const RodSide& other, const Sample& sample,
                 bool atStart) {
    const RodShape& shape = *other.shape;
    const SubArc& arc = atStart ? shape.subArcs.front() : shape.subArcs.back();
    const Vec2& end = atStart ? arc.p0 : arc.p1;
    if ((sample.p - end).squaredNorm() > e.distance * e.distance)
        return;
    Candidate c;
    c.b = {other.rod, arc.element, atStart ? arc.s0 : shape.endS};
    if (sampled.rod == other.rod && !differentParts(shape, sample.s, c.b.s))
        return;
    const EndHit hit = againstEnd(sample, end, atStart ? arc.t0 : arc.t1);
    if (sample.tip && !shape.closed)
        return addTipTip(e, sampled, other, c, sample, hit, end);
    setRodFrame(c, sample.p, sampled.shape->halfThickness, end, shape.halfThickness, hit.normal, hit.distance);
    addSample(e, sampled, other, c, sample, hit.left, true);
}

void sampleOnSubArc(const RodEvaluation& e, const RodSide& sampled, const RodSide& other, const Check& check) {
    SC_ASSERT_EXPENSIVE(check.first < sampled.shape->samples.size() && check.second < other.shape->subArcs.size(),
                        "a sample and a sub-arc of the two rods");
    const Sample& sample = sampled.shape->samples[check.first];
    const RodShape& shape = *other.shape;
    const SubArc& arc = shape.subArcs[check.second];
    const double ahead = aheadOfStart(arc, sample.p);
    const double beyond = aheadOfEnd(arc, sample.p);
    if (ahead < 0.0) {
        // The weld of a closed rod counts as an end if it has a kink and the sample lies in its wedge.
        if (check.second == 0 && (!shape.closed || aheadOfEnd(shape.subArcs.back(), sample.p) >= 0.0))
            sampleOnEnd(e, sampled, other, sample, true);
        return;
    }
    if (beyond >= 0.0) {
        if (check.second + 1U == shape.subArcs.size() && !shape.closed)
            sampleOnEnd(e, sampled, other, sample, false);
        return;
    }
    Foot foot;
    if (!footInSubArc(arc, sample.p, e.distance, foot))
        return;
    if (sampled.rod == other.rod && !differentParts(shape, sample.s, arc.s0 + foot.s))
        return;
    const bool left = liesLeft(sample, foot, arc.curvature, 1e-3 * e.tolerance);
    Candidate c;
    c.b = {other.rod, arc.element, arc.s0 + foot.s};
    setRodFrame(c, sample.p, sampled.shape->halfThickness, foot.point, shape.halfThickness,
                left ? foot.normal : Vec2(-foot.normal), std::abs(foot.distance));
    addSample(e, sampled, other, c, sample, left, atSample(shape, arc, foot.s, e.tolerance));
}

void interiorMinimum(const RodEvaluation& e, const Check& check, double depth) {
    const SubArc& a = e.a.shape->subArcs[check.first];
    const SubArc& b = e.b.shape->subArcs[check.second];
    ArcMinimum m;
    if (!arcArcMinimum(a, b, e.distance, depth, m))
        return;
    SC_ASSERT_EXPENSIVE(!(m.distance < 0.0) && !(m.distance > e.distance), "a minimum lies within reach");
    SC_ASSERT_EXPENSIVE(!(m.sA < 0.0) && !(m.sA > a.length) && !(m.sB < 0.0) && !(m.sB > b.length),
                        "an interior minimum lies on its sub-arcs");
    Candidate c;
    c.a = {e.a.rod, a.element, a.s0 + m.sA};
    c.b = {e.b.rod, b.element, b.s0 + m.sB};
    if (e.a.rod == e.b.rod && !differentParts(*e.a.shape, c.a.s, c.b.s))
        return;
    setRodFrame(c, m.pointA, e.a.shape->halfThickness, m.pointB, e.b.shape->halfThickness, m.normal, m.distance);
    c.id = makeId(e.a.key, e.b.key, Feature::Interior, elementPayload(a.element, b.element, a.part ^ b.part));
    e.reducer.add(c, canonicalS(*e.a.shape, c.a.s, e.tolerance), canonicalS(*e.b.shape, c.b.s, e.tolerance), 0.0,
                  atSample(*e.a.shape, a, m.sA, e.tolerance) || atSample(*e.b.shape, b, m.sB, e.tolerance));
}

} // namespace

bool differentParts(const RodShape& rod, double s1, double s2) {
    const double from = std::min(s1, s2);
    const double to = std::max(s1, s2);
    const double apart = 2.0 * kSelfThicknesses * rod.halfThickness;
    if (to - from <= apart)
        return false;
    AngleRange between{1e300, -1e300};
    includeTurn(rod, from, to, 0.0, between);
    if (between.high - between.low <= kRightAngle)
        return false;
    if (!rod.closed)
        return true;
    if (rod.length - (to - from) <= apart)
        return false;
    AngleRange around{1e300, -1e300};
    const SubArc& last = rod.subArcs.back();
    includeTurn(rod, to, last.s0 + last.length, 0.0, around);
    includeTurn(rod, rod.subArcs.front().s0, from, rod.turn.back(), around);
    return around.high - around.low > kRightAngle;
}

void setRodFrame(Candidate& c, const Vec2& centreA, double halfA, const Vec2& centreB, double halfB, const Vec2& normal,
                 double distance) {
    c.normal = normal;
    c.pointA = centreA - halfA * normal;
    c.pointB = centreB + halfB * normal;
    c.gap = distance - halfA - halfB;
}

bool liesLeft(const Sample& sample, const Foot& foot, double curvature, double tolerance) {
    if (std::abs(foot.distance) > tolerance)
        return foot.distance > 0.0;
    if (sample.tip)
        return (sample.index == 0 ? sample.t : Vec2(-sample.t)).dot(foot.normal) >= 0.0;
    return sample.curvature * rod::perp(sample.t).dot(foot.normal) >= curvature;
}

EndHit againstEnd(const Sample& sample, const Vec2& end, const Vec2& tangent) {
    const Vec2 w = sample.p - end;
    EndHit hit;
    hit.distance = w.norm();
    hit.normal = hit.distance > 1e-15 ? Vec2(w / hit.distance) : rod::perp(tangent);
    hit.left = rod::cross(tangent, w) >= 0.0;
    return hit;
}

void evaluateRodPair(const RodSide& a, const RodSide& b, const RodPairChecks& checks, double reach,
                     CandidateReducer& reducer, std::vector<Candidate>& out) {
    SC_ASSERT(a.key <= b.key, "side A is the rod with the smaller key");
    SC_ASSERT(a.rod != b.rod || checks.samplesOfB.empty(), "a rod with itself is sampled once");
    const double halves = a.shape->halfThickness + b.shape->halfThickness;
    const double distance = halves + reach;
    if (distance < 0.0)
        return;
    reducer.begin(kSameShare * halves);
    const RodEvaluation e{a, b, distance, kSameShare * halves, reducer};
    for (const Check& check : checks.samplesOfA)
        sampleOnSubArc(e, a, b, check);
    for (const Check& check : checks.samplesOfB)
        sampleOnSubArc(e, b, a, check);
    for (const Check& check : checks.subArcs)
        interiorMinimum(e, check, kConditionedShare * halves);
    reducer.finish(out);
}

} // namespace supercircle::contact
