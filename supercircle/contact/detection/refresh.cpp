// One candidate after a small motion. Every local minimum of the distance is followed downhill from where it was, piece
// by piece, with the same closed forms as detection: at rest the same digits come out.
//
// A rod sample keeps the side it had: should the centre lines pass through each other within the motion, the gap goes
// on growing more negative instead of turning round, which detection, knowing no history, cannot offer.

#include "supercircle/contact/detection.h"
#include "supercircle/contact/detection/outline_pair.h"
#include "supercircle/contact/detection/rod_pair.h"

#include <cmath>

namespace supercircle::contact {

namespace {

/// A piece of a curve that can walk to its neighbours.
class Walker {
public:
    Walker(const Curve& curve, const RodPoint& at) : curve_(curve), element_(at.element) {
        const auto e = static_cast<std::size_t>(element_);
        const std::int32_t parts = pieceCount(curve.arcs[e]);
        const double u = (at.s - curve.nodeS[e]) / curve.arcs[e].length * parts;
        part_ = std::min(std::max(static_cast<std::int32_t>(std::floor(u)), 0), parts - 1);
        piece_ = pieceOf(curve_, element_, part_);
    }
    [[nodiscard]] const Piece& piece() const { return piece_; }
    /// To the neighbour before (-1) or after (+1); false at a tip.
    bool step(int direction) {
        const auto n = static_cast<std::int32_t>(curve_.arcs.size());
        part_ += direction;
        if (part_ < 0 || part_ >= pieceCount(curve_.arcs[static_cast<std::size_t>(element_)])) {
            const std::int32_t next = element_ + direction;
            if ((next < 0 || next >= n) && !curve_.closed) {
                part_ -= direction;
                return false;
            }
            element_ = (next + n) % n;
            part_ = direction > 0 ? 0 : pieceCount(curve_.arcs[static_cast<std::size_t>(element_)]) - 1;
        }
        piece_ = pieceOf(curve_, element_, part_);
        return true;
    }

private:
    const Curve& curve_;
    std::int32_t element_;
    std::int32_t part_ = 0;
    Piece piece_;
};

constexpr double kAnywhere = 1e300;
constexpr int kMaxSteps = 64;

enum class Arrival { Interior, Start, End, Lost };

/// Walks downhill to the local minimum of the distance from p.
Arrival walkTo(Walker& walker, const Vec2& p) {
    int last = 0;
    for (int i = 0; i < kMaxSteps; ++i) {
        const Piece& piece = walker.piece();
        const int direction = aheadOfStart(piece, p) < 0.0 ? -1 : (aheadOfEnd(piece, p) >= 0.0 ? 1 : 0);
        if (direction == 0)
            return Arrival::Interior;
        if (direction == -last)
            return direction > 0 ? Arrival::End : Arrival::Start; // the kink of a weld
        if (!walker.step(direction))
            return direction > 0 ? Arrival::End : Arrival::Start;
        last = direction;
    }
    return Arrival::Lost;
}

bool refreshSample(Candidate& c, const Curve& a, const Curve& b) {
    const Sample sample = sampleAt(a, c.a.element, c.a.s);
    Walker walker(b, c.b);
    const Arrival arrival = walkTo(walker, sample.p);
    const Piece& piece = walker.piece();
    if (arrival == Arrival::Lost)
        return false;
    if (arrival != Arrival::Interior) {
        const bool start = arrival == Arrival::Start;
        const Vec2& end = start ? piece.p0 : piece.p1;
        const EndHit hit = againstEnd(sample, end, start ? piece.t0 : piece.t1);
        const bool whole = start ? piece.element == 0 : piece.element + 1 == static_cast<std::int32_t>(b.arcs.size());
        c.b.element = piece.element;
        c.b.s = start ? piece.s0 : (whole ? b.nodeS.back() : piece.s0 + piece.length);
        setRodFrame(c, sample.p, a.halfThickness, end, b.halfThickness, hit.normal, hit.distance);
        return true;
    }
    Foot foot;
    if (!footInPiece(piece, sample.p, kAnywhere, foot))
        return false;
    const bool left = (c.id & 0x200u) != 0;
    c.b.element = piece.element;
    c.b.s = piece.s0 + foot.s;
    setRodFrame(c, sample.p, a.halfThickness, foot.point, b.halfThickness, left ? foot.normal : Vec2(-foot.normal),
                left ? foot.distance : -foot.distance);
    return true;
}

bool refreshTipTip(Candidate& c, const Curve& a, const Curve& b) {
    const Sample tipA = sampleAt(a, c.a.element, c.a.s);
    const Sample tipB = sampleAt(b, c.b.element, c.b.s);
    const auto beyond = [](const Sample& tip, const Vec2& p) {
        const double ahead = (p - tip.p).dot(tip.t);
        return tip.index == 0 ? ahead < 0.0 : ahead >= 0.0;
    };
    if (!beyond(tipA, tipB.p) && !beyond(tipB, tipA.p))
        return false;
    // The same rounding as in detection, which goes from the end to the sample.
    const EndHit hit = againstEnd(tipA, tipB.p, tipB.t);
    setRodFrame(c, tipA.p, a.halfThickness, tipB.p, b.halfThickness, hit.normal, hit.distance);
    return true;
}

bool refreshInterior(Candidate& c, const Curve& a, const Curve& b) {
    Walker onA(a, c.a);
    Walker onB(b, c.b);
    for (int i = 0; i < kMaxSteps; ++i) {
        const Piece& pieceA = onA.piece();
        const Piece& pieceB = onB.piece();
        ArcMinimum m;
        if (arcArcMinimum(pieceA, pieceB, kAnywhere, 0.0, m)) {
            c.a = {c.a.rod, pieceA.element, pieceA.s0 + m.sA};
            c.b = {c.b.rod, pieceB.element, pieceB.s0 + m.sB};
            setRodFrame(c, m.pointA, a.halfThickness, m.pointB, b.halfThickness, m.normal, m.distance);
            return true;
        }
        const Steps steps = stepsToMinimum(pieceA, pieceB);
        if (steps.a == 0 && steps.b == 0)
            return false;
        if (steps.a != 0 && !onA.step(steps.a))
            return false;
        if (steps.b != 0 && !onB.step(steps.b))
            return false;
    }
    return false;
}

bool refreshSampleOutline(Candidate& c, const Curve& rod, const OutlineShape& shape) {
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

bool refreshInteriorOutline(Candidate& c, const Curve& rod, const OutlineShape& shape) {
    Walker walker(rod, c.a);
    const std::int32_t face = faceOf(c.id);
    const bool disc = shape.kind == OutlineKind::Circle;
    if (!disc && static_cast<std::size_t>(face) >= shape.faces.size())
        return false;
    if (disc) {
        if (walkTo(walker, shape.centre) != Arrival::Interior)
            return false;
    } else {
        const Vec2& up = shape.faces[static_cast<std::size_t>(face)].normal;
        int i = 0;
        for (; i < kMaxSteps; ++i) {
            const int direction = walker.piece().t0.dot(up) >= 0.0 ? -1 : (walker.piece().t1.dot(up) < 0.0 ? 1 : 0);
            if (direction == 0)
                break;
            if (!walker.step(direction))
                return false;
        }
        if (i == kMaxSteps)
            return false;
    }
    double s = 0.0;
    Candidate moved = c;
    if (!interiorOutline(walker.piece(), rod.halfThickness, shape, face, kAnywhere, moved, s))
        return false;
    c = moved;
    c.a = {c.a.rod, walker.piece().element, walker.piece().s0 + s};
    return true;
}

bool refreshCorner(Candidate& c, const Curve& rod, const OutlineShape& shape) {
    const std::int32_t index = sampleOf(c.id);
    for (const Corner& corner : shape.corners) {
        if (corner.index != index)
            continue;
        Walker walker(rod, c.a);
        Foot foot;
        Vec2 normal;
        double distance = 0.0;
        if (walkTo(walker, corner.p) != Arrival::Interior)
            return false;
        if (!footInPiece(walker.piece(), corner.p, kAnywhere, foot))
            return false;
        if (!cornerHit(corner, foot, outlineDepth(rod.halfThickness, shape), normal, distance))
            return false;
        setOutlineFrame(c, foot.point, rod.halfThickness, shape, corner.p, normal, distance);
        c.a = {c.a.rod, walker.piece().element, walker.piece().s0 + foot.s};
        return true;
    }
    return false;
}

bool inRange(const RodPoint& p, const std::vector<Curve>& curves) {
    return p.rod >= 0 && static_cast<std::size_t>(p.rod) < curves.size() && p.element >= 0 &&
           static_cast<std::size_t>(p.element) < curves[static_cast<std::size_t>(p.rod)].arcs.size();
}

} // namespace

bool refresh(Candidate& c, const std::vector<Curve>& curves, const std::vector<Outline>& outlines) {
    if (!inRange(c.a, curves))
        return false;
    const Curve& a = curves[static_cast<std::size_t>(c.a.rod)];
    const Feature kind = featureOf(c.id);
    if (kind == Feature::SampleRod || kind == Feature::TipTip || kind == Feature::Interior) {
        if (!inRange(c.b, curves))
            return false;
        const Curve& b = curves[static_cast<std::size_t>(c.b.rod)];
        if (kind == Feature::SampleRod)
            return refreshSample(c, a, b);
        return kind == Feature::TipTip ? refreshTipTip(c, a, b) : refreshInterior(c, a, b);
    }
    if (c.outline < 0 || static_cast<std::size_t>(c.outline) >= outlines.size())
        return false;
    static thread_local OutlineShape shape; // storage only, prepared anew
    prepare(outlines[static_cast<std::size_t>(c.outline)], shape);
    if (kind == Feature::SampleOutline)
        return refreshSampleOutline(c, a, shape);
    if (kind == Feature::InteriorOutline)
        return refreshInteriorOutline(c, a, shape);
    return refreshCorner(c, a, shape);
}

} // namespace supercircle::contact
