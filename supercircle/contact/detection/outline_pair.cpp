#include "supercircle/contact/detection/outline_pair.h"

#include "supercircle/support/invariants.h"

#include <cmath>

namespace supercircle::contact {

namespace {

struct OutlineEvaluation {
    const RodSide& rod;
    const OutlineSide& outline;
    double reach;
    double depth;
    double tolerance;
    CandidateReducer& reducer;
};

void sampleOnOutline(const OutlineEvaluation& e, const Sample& sample) {
    OutlineHit hit;
    const OutlineShape& shape = *e.outline.shape;
    if (!closestOnOutline(shape, sample.p, e.depth, inwardOf(sample), hit))
        return;
    Candidate c;
    setOutlineFrame(c, sample.p, e.rod.shape->halfThickness, shape, hit.point, hit.normal, hit.distance);
    if (!(c.gap <= e.reach))
        return;
    c.a = {e.rod.rod, sample.element, sample.s};
    c.outline = e.outline.outline;
    // Only a two-sided segment has sides.
    const bool left = shape.kind == OutlineKind::Segment && shape.faces[0].normal.dot(hit.normal) >= 0.0;
    c.id = makeId(e.rod.key, e.outline.key, Feature::SampleOutline, samplePayload(sample.index, left, 0));
    e.reducer.add(c, sample.s, c.pointB.x(), c.pointB.y(), hit.face < 0);
}

bool atSample(const OutlineEvaluation& e, const SubArc& arc, double s) {
    return s <= e.tolerance || arc.length - s <= e.tolerance || std::abs(arc.s0 + s - e.rod.shape->midS) <= e.tolerance;
}

void subArcOnOutline(const OutlineEvaluation& e, const SubArc& arc) {
    const OutlineShape& shape = *e.outline.shape;
    const auto faces = shape.kind == OutlineKind::Circle ? 1 : static_cast<std::int32_t>(shape.faces.size());
    for (std::int32_t face = 0; face < faces; ++face) {
        Candidate c;
        double s = 0.0;
        if (!interiorOutline(arc, e.rod.shape->halfThickness, shape, face, e.reach, c, s))
            continue;
        c.a = {e.rod.rod, arc.element, arc.s0 + s};
        c.outline = e.outline.outline;
        c.id = makeId(e.rod.key, e.outline.key, Feature::InteriorOutline, elementPayload(arc.element, face, arc.part));
        e.reducer.add(c, c.a.s, c.pointB.x(), c.pointB.y(), atSample(e, arc, s));
    }
}

void cornerOnSubArc(const OutlineEvaluation& e, const Corner& corner, const SubArc& arc) {
    const double halves = e.rod.shape->halfThickness + e.outline.shape->radius;
    Foot foot;
    if (!footInSubArc(arc, corner.p, halves + e.reach, foot))
        return;
    Vec2 normal;
    double distance = 0.0;
    if (!cornerHit(corner, foot, e.depth, normal, distance))
        return;
    Candidate c;
    setOutlineFrame(c, foot.point, e.rod.shape->halfThickness, *e.outline.shape, corner.p, normal, distance);
    c.a = {e.rod.rod, arc.element, arc.s0 + foot.s};
    c.outline = e.outline.outline;
    c.id = makeId(e.rod.key, e.outline.key, Feature::CornerRod, samplePayload(corner.index, foot.distance >= 0.0, 0));
    e.reducer.addRanked(c, c.a.s, c.pointB.x(), c.pointB.y(), atSample(e, arc, foot.s));
}

} // namespace

double outlineDepth(double halfThickness, const OutlineShape& shape) {
    return 2.0 * halfThickness + shape.radius;
}

void setOutlineFrame(Candidate& c, const Vec2& centreA, double halfA, const OutlineShape& shape, const Vec2& point,
                     const Vec2& normal, double distance) {
    c.normal = normal;
    c.pointA = centreA - halfA * normal;
    c.pointB = point + shape.radius * normal;
    c.gap = distance - halfA - shape.radius;
}

Vec2 inwardOf(const Sample& sample) {
    if (sample.tip)
        return sample.index == 0 ? sample.t : Vec2(-sample.t);
    return sample.curvature < 0.0 ? Vec2(-rod::perp(sample.t)) : rod::perp(sample.t);
}

namespace {

/// A sub-arc lies along an outline if its middle is less than this fraction of the half thickness behind its ends. It
/// is five times the gap that a step in games may leave: a middle that it leaves out cannot be pressed in that step.
/// Four times as much adds candidates that are never loaded; a fifth changes no creep of the capstan.
constexpr double kLyingShare = 0.1;

/// The middle of a sub-arc that lies along a face or disc. Such a sub-arc has no extremal point whose place is more
/// than round-off, but it presses with its middle, too: nodes alone cannot balance the pressure that bends it between
/// them, and the strip would slide while its elements give way in turn (decision 0185).
bool middleOnOutline(const SubArc& arc, double halfThickness, const OutlineShape& shape, std::int32_t face,
                     double maxGap, Candidate& c, double& s) {
    const bool disc = shape.kind == OutlineKind::Circle;
    const Vec2 from = arc.p0 - (disc ? shape.centre : shape.faces[static_cast<std::size_t>(face)].start);
    const double away = disc ? from.norm() : from.dot(shape.faces[static_cast<std::size_t>(face)].normal);
    if (away > halfThickness + shape.radius + maxGap + arc.length)
        return false;
    const Foot middle = pointOnSubArc(arc, 0.5 * arc.length);
    const Vec2 inward = disc ? middle.normal : shape.faces[static_cast<std::size_t>(face)].normal;
    OutlineHit hit;
    if (!closestOnOutline(shape, middle.point, outlineDepth(halfThickness, shape), inward, hit))
        return false;
    if (disc ? !(hit.distance > 0.0) : hit.face != face)
        return false;
    const double relative = (disc ? 1.0 / hit.distance : 0.0) + arc.curvature * middle.normal.dot(hit.normal);
    const double bulge = relative * arc.span * arc.span / 8.0;
    if (bulge >= kConditionedShare * halfThickness || bulge < -kLyingShare * halfThickness)
        return false;
    setOutlineFrame(c, middle.point, halfThickness, shape, hit.point, hit.normal, hit.distance);
    s = middle.s;
    return c.gap <= maxGap;
}

} // namespace

bool interiorOutline(const SubArc& arc, double halfThickness, const OutlineShape& shape, std::int32_t face,
                     double maxGap, Candidate& c, double& s) {
    const double depth = kConditionedShare * halfThickness;
    Foot foot;
    if (shape.kind == OutlineKind::Circle) {
        if (!footInSubArc(arc, shape.centre, shape.radius + halfThickness + maxGap, foot))
            return middleOnOutline(arc, halfThickness, shape, face, maxGap, c, s);
        const double distance = std::abs(foot.distance);
        if (!(distance > 0.0))
            return false;
        // From the disc to the rod; the rod's curvature counts positive when it bends away from the disc.
        const Vec2 normal = foot.distance > 0.0 ? Vec2(-foot.normal) : foot.normal;
        const double bend = foot.distance > 0.0 ? -arc.curvature : arc.curvature;
        const double relative = 1.0 / distance + bend;
        if (!(relative * arc.span * arc.span / 8.0 >= depth))
            return middleOnOutline(arc, halfThickness, shape, face, maxGap, c, s);
        setOutlineFrame(c, foot.point, halfThickness, shape, shape.centre, normal, distance);
        s = foot.s;
        return c.gap <= maxGap;
    }
    const auto f = static_cast<std::size_t>(face);
    if (f >= shape.faces.size())
        return false;
    if (!lowestPoint(arc, shape.faces[f].normal, depth, foot))
        return middleOnOutline(arc, halfThickness, shape, face, maxGap, c, s);
    const double y = (foot.point - shape.faces[f].start).dot(shape.faces[f].normal);
    if (!(y - halfThickness - shape.radius <= maxGap))
        return false;
    OutlineHit hit;
    if (!closestOnOutline(shape, foot.point, outlineDepth(halfThickness, shape), shape.faces[f].normal, hit))
        return false;
    if (hit.face != face)
        return false;
    setOutlineFrame(c, foot.point, halfThickness, shape, hit.point, hit.normal, hit.distance);
    s = foot.s;
    SC_ASSERT_EXPENSIVE(!(s < 0.0) && !(s > arc.length), "an extremal point lies on its sub-arc");
    return true;
}

void evaluateOutlinePair(const RodSide& rod, const OutlineSide& outline, const OutlinePairChecks& checks, double reach,
                         CandidateReducer& reducer, std::vector<Candidate>& out) {
    const double half = rod.shape->halfThickness;
    const OutlineShape& shape = *outline.shape;
    SC_ASSERT(rod.shape->samples.size() <= 0xffff && rod.shape->subArcs.size() <= 0xffff, "checks index in 16 bits");
    reducer.begin(kSameShare * half);
    const OutlineEvaluation e{rod, outline, reach, outlineDepth(half, shape), kSameShare * half, reducer};
    for (const std::uint16_t i : checks.samples)
        sampleOnOutline(e, rod.shape->samples[i]);
    for (const std::uint16_t i : checks.subArcs)
        subArcOnOutline(e, rod.shape->subArcs[i]);
    for (const Check& check : checks.corners)
        cornerOnSubArc(e, shape.corners[check.first], rod.shape->subArcs[check.second]);
    reducer.finish(out);
}

} // namespace supercircle::contact
