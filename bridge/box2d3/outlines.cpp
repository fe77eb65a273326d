// Which side is solid: bodies stay on the right of Box2D's chain segments p1 -> p2. The core's outlines have their
// solid on the right, and rods stay on the left. Chain segments therefore change direction here.
//
// Ends of open chains: Box2D 3 makes no segment of the first and last edge of an open chain; they are ghosts. The ends
// of the other segments are free corners for shells, even if another chain continues there. A corner in a smooth wall
// is harmless, a missing one is a hole.

#include "bridge/box2d3/outlines.h"

#include <vector>

namespace supercircle::box2d3 {

namespace {

using contact::Outline;
using contact::OutlineKind;
using step::Vec2;

constexpr std::uint32_t kMostKeys = 1u << 20; // of contact::Outline::key

/// Host point of the body frame -> SI point relative to the centre of mass.
struct ToLocal {
    b2Vec2 centre;
    double scale;
    Vec2 operator()(const b2Vec2& p) const {
        return {(static_cast<double>(p.x) - static_cast<double>(centre.x)) / scale,
                (static_cast<double>(p.y) - static_cast<double>(centre.y)) / scale};
    }
};

bool same(const b2Vec2& a, const b2Vec2& b) {
    return a.x == b.x && a.y == b.y;
}

void chainSegment(b2ShapeId shape, const ToLocal& local, Outline& out) {
    const b2ChainSegment c = b2Shape_GetChainSegment(shape);
    out.kind = OutlineKind::OneSided;
    out.points = {local(c.segment.point2), local(c.segment.point1)}; // reversed, see the top of this file
    const b2ChainId chain = b2Shape_GetParentChain(shape);
    std::vector<b2ShapeId> all(static_cast<std::size_t>(b2Chain_GetSegmentCount(chain)));
    all.resize(static_cast<std::size_t>(b2Chain_GetSegments(chain, all.data(), static_cast<int>(all.size()))));
    if (all.empty())
        return;
    const b2Segment first = b2Shape_GetChainSegment(all.front()).segment;
    const b2Segment last = b2Shape_GetChainSegment(all.back()).segment;
    const bool loop = same(first.point1, last.point2);
    out.joinedStart = loop || !B2_ID_EQUALS(shape, all.back());
    out.joinedEnd = loop || !B2_ID_EQUALS(shape, all.front());
    if (out.joinedStart)
        out.neighbourStart = local(c.ghost2);
    if (out.joinedEnd)
        out.neighbourEnd = local(c.ghost1);
}

} // namespace

bool isSolid(b2ShapeId shape) {
    const b2Filter filter = b2Shape_GetFilter(shape);
    return !b2Shape_IsSensor(shape) && (filter.maskBits != 0 || filter.groupIndex > 0);
}

Outline outlineOf(b2ShapeId shape, double unitsPerMetre) {
    Outline out;
    out.key = static_cast<std::uint32_t>(shape.index1) % kMostKeys;
    const b2Filter filter = b2Shape_GetFilter(shape);
    out.category = static_cast<std::uint32_t>(filter.categoryBits);
    out.mask = static_cast<std::uint32_t>(filter.maskBits);
    out.group = filter.groupIndex;
    const ToLocal local{b2Body_GetLocalCenterOfMass(b2Shape_GetBody(shape)), unitsPerMetre};
    const auto length = [&](float r) { return static_cast<double>(r) / unitsPerMetre; };
    switch (b2Shape_GetType(shape)) {
    case b2_circleShape: {
        const b2Circle c = b2Shape_GetCircle(shape);
        out.kind = OutlineKind::Circle;
        out.points = {local(c.center)};
        out.radius = length(c.radius);
        break;
    }
    case b2_capsuleShape: {
        const b2Capsule c = b2Shape_GetCapsule(shape);
        out.kind = OutlineKind::Segment;
        out.points = {local(c.center1), local(c.center2)};
        out.radius = length(c.radius);
        break;
    }
    case b2_segmentShape: {
        const b2Segment s = b2Shape_GetSegment(shape);
        out.kind = OutlineKind::Segment;
        out.points = {local(s.point1), local(s.point2)};
        break;
    }
    case b2_polygonShape: {
        const b2Polygon p = b2Shape_GetPolygon(shape);
        out.kind = OutlineKind::Polygon;
        for (int i = 0; i < p.count; ++i)
            out.points.push_back(local(p.vertices[i]));
        out.radius = length(p.radius);
        break;
    }
    case b2_chainSegmentShape:
        chainSegment(shape, local, out);
        break;
    case b2_shapeTypeCount:
        break;
    }
    return out;
}

} // namespace supercircle::box2d3
