// Update of one candidate after a small motion. Every local minimum of the distance is followed downhill from its last
// position, sub-arc by sub-arc, with the closed forms of detection. At rest the result is bitwise identical.
//
// A rod sample keeps its side. If the centre lines pass through each other within the motion, the gap becomes more
// negative instead of changing its sign. Detection cannot do this, because it knows no history.

#include "supercircle/contact/detection.h"
#include "supercircle/contact/detection/outline_pair.h"
#include "supercircle/contact/detection/rod_pair.h"
#include "supercircle/support/invariants.h"

#include <cmath>

namespace supercircle::contact {

namespace {

/// Follows a feature from sub-arc to sub-arc of a curve.
class FeatureTracker {
public:
    FeatureTracker(const RodCurve& curve, const RodPoint& at) : curve_(curve), element_(at.element) {
        const auto e = static_cast<std::size_t>(element_);
        const std::int32_t parts = subArcCount(curve.arcs[e]);
        SC_ASSERT_EXPENSIVE(parts > 0, "an arc has a sub-arc at least");
        const double u = (at.s - curve.nodeS[e]) / curve.arcs[e].length * parts;
        part_ = std::min(std::max(static_cast<std::int32_t>(std::floor(u)), 0), parts - 1);
        arc_ = subArcOf(curve_, element_, part_);
    }
    [[nodiscard]] const SubArc& arc() const { return arc_; }
    /// Moves to the neighbour before (-1) or after (+1); false at a tip.
    bool step(int direction) {
        const auto n = static_cast<std::int32_t>(curve_.arcs.size());
        part_ += direction;
        if (part_ < 0 || part_ >= subArcCount(curve_.arcs[static_cast<std::size_t>(element_)])) {
            const std::int32_t next = element_ + direction;
            if ((next < 0 || next >= n) && !curve_.closed) {
                part_ -= direction;
                return false;
            }
            element_ = (next + n) % n;
            part_ = direction > 0 ? 0 : subArcCount(curve_.arcs[static_cast<std::size_t>(element_)]) - 1;
        }
        arc_ = subArcOf(curve_, element_, part_);
        return true;
    }

private:
    const RodCurve& curve_;
    std::int32_t element_;
    std::int32_t part_ = 0;
    SubArc arc_;
};

constexpr double kAnywhere = 1e300;
constexpr int kMaxSteps = 64;

enum class FootLocation { Interior, Start, End, NotFound };

/// Follows the distance from p downhill to its local minimum.
FootLocation trackClosest(FeatureTracker& tracker, const Vec2& p) {
    int last = 0;
    for (int i = 0; i < kMaxSteps; ++i) {
        const SubArc& arc = tracker.arc();
        const int direction = aheadOfStart(arc, p) < 0.0 ? -1 : (aheadOfEnd(arc, p) >= 0.0 ? 1 : 0);
        if (direction == 0)
            return FootLocation::Interior;
        if (direction == -last)
            return direction > 0 ? FootLocation::End : FootLocation::Start; // the kink of a weld
        if (!tracker.step(direction))
            return direction > 0 ? FootLocation::End : FootLocation::Start;
        last = direction;
    }
    return FootLocation::NotFound;
}

bool updateSample(Candidate& c, const RodCurve& a, const RodCurve& b) {
    const Sample sample = sampleAt(a, c.a.element, c.a.s);
    FeatureTracker tracker(b, c.b);
    const FootLocation location = trackClosest(tracker, sample.p);
    const SubArc& arc = tracker.arc();
    if (location == FootLocation::NotFound)
        return false;
    if (location != FootLocation::Interior) {
        const bool start = location == FootLocation::Start;
        const Vec2& end = start ? arc.p0 : arc.p1;
        const EndHit hit = againstEnd(sample, end, start ? arc.t0 : arc.t1);
        const bool whole = start ? arc.element == 0 : arc.element + 1 == static_cast<std::int32_t>(b.arcs.size());
        c.b.element = arc.element;
        c.b.s = start ? arc.s0 : (whole ? b.nodeS.back() : arc.s0 + arc.length);
        setRodFrame(c, sample.p, a.halfThickness, end, b.halfThickness, hit.normal, hit.distance);
        return true;
    }
    Foot foot;
    if (!footInSubArc(arc, sample.p, kAnywhere, foot))
        return false;
    const bool left = (c.id & 0x200u) != 0;
    c.b.element = arc.element;
    c.b.s = arc.s0 + foot.s;
    setRodFrame(c, sample.p, a.halfThickness, foot.point, b.halfThickness, left ? foot.normal : Vec2(-foot.normal),
                left ? foot.distance : -foot.distance);
    return true;
}

bool updateTipTip(Candidate& c, const RodCurve& a, const RodCurve& b) {
    const Sample tipA = sampleAt(a, c.a.element, c.a.s);
    const Sample tipB = sampleAt(b, c.b.element, c.b.s);
    const auto beyond = [](const Sample& tip, const Vec2& p) {
        const double ahead = (p - tip.p).dot(tip.t);
        return tip.index == 0 ? ahead < 0.0 : ahead >= 0.0;
    };
    if (!beyond(tipA, tipB.p) && !beyond(tipB, tipA.p))
        return false;
    // Same order of operations as in detection, from the end to the sample.
    const EndHit hit = againstEnd(tipA, tipB.p, tipB.t);
    setRodFrame(c, tipA.p, a.halfThickness, tipB.p, b.halfThickness, hit.normal, hit.distance);
    return true;
}

bool updateInterior(Candidate& c, const RodCurve& a, const RodCurve& b) {
    FeatureTracker onA(a, c.a);
    FeatureTracker onB(b, c.b);
    for (int i = 0; i < kMaxSteps; ++i) {
        const SubArc& arcA = onA.arc();
        const SubArc& arcB = onB.arc();
        ArcMinimum m;
        if (arcArcMinimum(arcA, arcB, kAnywhere, 0.0, m)) {
            c.a = {c.a.rod, arcA.element, arcA.s0 + m.sA};
            c.b = {c.b.rod, arcB.element, arcB.s0 + m.sB};
            setRodFrame(c, m.pointA, a.halfThickness, m.pointB, b.halfThickness, m.normal, m.distance);
            return true;
        }
        const NeighbourSteps steps = stepsToMinimum(arcA, arcB);
        if (steps.a == 0 && steps.b == 0)
            return false;
        if (steps.a != 0 && !onA.step(steps.a))
            return false;
        if (steps.b != 0 && !onB.step(steps.b))
            return false;
    }
    return false;
}

bool updateSampleOutline(Candidate& c, const RodCurve& rod, const OutlineShape& shape) {
    const Sample sample = sampleAt(rod, c.a.element, c.a.s);
    OutlineHit hit;
    if (!closestOnOutline(shape, sample.p, outlineDepth(rod.halfThickness, shape), inwardOf(sample), hit))
        return false;
    if (shape.kind == OutlineKind::Segment && hit.face >= 0) { // keeps its side
        const bool left = (c.id & 0x200u) != 0;
        if (left != (hit.face == 0)) {
            hit.normal = -hit.normal;
            hit.distance = -hit.distance;
        }
    }
    setOutlineFrame(c, sample.p, rod.halfThickness, shape, hit.point, hit.normal, hit.distance);
    return true;
}

bool updateInteriorOutline(Candidate& c, const RodCurve& rod, const OutlineShape& shape) {
    FeatureTracker tracker(rod, c.a);
    const std::int32_t face = faceOf(c.id);
    const bool disc = shape.kind == OutlineKind::Circle;
    if (!disc && static_cast<std::size_t>(face) >= shape.faces.size())
        return false;
    const auto found = [&] {
        double s = 0.0;
        Candidate moved = c;
        if (!interiorOutline(tracker.arc(), rod.halfThickness, shape, face, kAnywhere, moved, s))
            return false;
        c = moved;
        c.a = {c.a.rod, tracker.arc().element, tracker.arc().s0 + s};
        return true;
    };
    if (found()) // its extremal point is on the same sub-arc, or the middle of that one stands for it
        return true;
    if (disc) {
        if (trackClosest(tracker, shape.centre) != FootLocation::Interior)
            return false;
    } else {
        const Vec2& up = shape.faces[static_cast<std::size_t>(face)].normal;
        int i = 0;
        for (; i < kMaxSteps; ++i) {
            const int direction = tracker.arc().t0.dot(up) >= 0.0 ? -1 : (tracker.arc().t1.dot(up) < 0.0 ? 1 : 0);
            if (direction == 0)
                break;
            if (!tracker.step(direction))
                return false;
        }
        if (i == kMaxSteps)
            return false;
    }
    return found();
}

bool updateCorner(Candidate& c, const RodCurve& rod, const OutlineShape& shape) {
    const std::int32_t index = sampleOf(c.id);
    for (const Corner& corner : shape.corners) {
        if (corner.index != index)
            continue;
        FeatureTracker tracker(rod, c.a);
        Foot foot;
        Vec2 normal;
        double distance = 0.0;
        if (trackClosest(tracker, corner.p) != FootLocation::Interior)
            return false;
        if (!footInSubArc(tracker.arc(), corner.p, kAnywhere, foot))
            return false;
        if (!cornerHit(corner, foot, outlineDepth(rod.halfThickness, shape), normal, distance))
            return false;
        setOutlineFrame(c, foot.point, rod.halfThickness, shape, corner.p, normal, distance);
        c.a = {c.a.rod, tracker.arc().element, tracker.arc().s0 + foot.s};
        return true;
    }
    return false;
}

bool inRange(const RodPoint& p, const std::vector<RodCurve>& curves) {
    return p.rod >= 0 && static_cast<std::size_t>(p.rod) < curves.size() && p.element >= 0 &&
           static_cast<std::size_t>(p.element) < curves[static_cast<std::size_t>(p.rod)].arcs.size();
}

bool update(Candidate& c, const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines) {
    if (!inRange(c.a, curves))
        return false;
    const RodCurve& a = curves[static_cast<std::size_t>(c.a.rod)];
    const Feature kind = featureOf(c.id);
    if (kind == Feature::SampleRod || kind == Feature::TipTip || kind == Feature::Interior) {
        if (!inRange(c.b, curves))
            return false;
        const RodCurve& b = curves[static_cast<std::size_t>(c.b.rod)];
        if (kind == Feature::SampleRod)
            return updateSample(c, a, b);
        return kind == Feature::TipTip ? updateTipTip(c, a, b) : updateInterior(c, a, b);
    }
    if (c.outline < 0 || static_cast<std::size_t>(c.outline) >= outlines.size())
        return false;
    static thread_local OutlineShape shape; // storage only, prepared anew
    prepare(outlines[static_cast<std::size_t>(c.outline)], shape);
    if (kind == Feature::SampleOutline)
        return updateSampleOutline(c, a, shape);
    if (kind == Feature::InteriorOutline)
        return updateInteriorOutline(c, a, shape);
    return updateCorner(c, a, shape);
}

} // namespace

bool updateCandidate(Candidate& c, const std::vector<RodCurve>& curves, const std::vector<Outline>& outlines) {
    const std::uint64_t id = c.id;
    const bool found = update(c, curves, outlines);
    SC_ASSERT(c.id == id, "an update follows one pair of features");
    SC_ASSERT(!found || invariants::isUnit(c.normal), "a normal has length 1");
    SC_ASSERT_EXPENSIVE(!found || inRange(c.a, curves), "side A is a point of a rod");
    SC_ASSERT_EXPENSIVE(!found || c.b.rod < 0 || inRange(c.b, curves), "side B is an outline or a point of a rod");
    return found;
}

} // namespace supercircle::contact
