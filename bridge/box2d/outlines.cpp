// Which side is solid: bodies stay on the right of Box2D's one-sided edges v1 -> v2. The core's outlines have their
// solid on the right, and rods stay on the left. One-sided edges therefore change direction here, so that a shell stays
// on the side on which Box2D keeps its own bodies.

#include "bridge/box2d/outlines.h"

namespace supercircle::bridge {

namespace {

using contact::Outline;
using contact::OutlineKind;
using step::Vec2;

/// Host point of the body frame -> SI point relative to the centre of mass.
struct ToLocal {
    b2Vec2 centre;
    double scale;
    Vec2 operator()(const b2Vec2& p) const {
        return {(static_cast<double>(p.x) - static_cast<double>(centre.x)) / scale,
                (static_cast<double>(p.y) - static_cast<double>(centre.y)) / scale};
    }
};

void edge(const b2EdgeShape& shape, const ToLocal& local, Outline& out) {
    if (!shape.m_oneSided) {
        out.kind = OutlineKind::Segment;
        out.points = {local(shape.m_vertex1), local(shape.m_vertex2)};
        return;
    }
    out.kind = OutlineKind::OneSided;
    out.points = {local(shape.m_vertex2), local(shape.m_vertex1)}; // reversed, see the top of this file
    out.joinedStart = out.joinedEnd = true;
    out.neighbourStart = local(shape.m_vertex3);
    out.neighbourEnd = local(shape.m_vertex0);
}

void chainEdge(const b2ChainShape& shape, int32 child, const ToLocal& local, Outline& out) {
    out.kind = OutlineKind::OneSided;
    const b2Vec2* v = shape.m_vertices;
    const int32 last = shape.m_count - 1;
    out.points = {local(v[child + 1]), local(v[child])}; // reversed, see the top of this file
    // Box2D needs ghost vertices at the ends of an open chain, but there is no edge, and their positions are arbitrary:
    // an end is a free corner. A loop repeats its first vertex as the last.
    const bool loop = v[0].x == v[last].x && v[0].y == v[last].y;
    out.joinedStart = loop || child + 1 < last;
    out.joinedEnd = loop || child > 0;
    if (out.joinedStart)
        out.neighbourStart = local(child + 1 < last ? v[child + 2] : v[1]);
    if (out.joinedEnd)
        out.neighbourEnd = local(child > 0 ? v[child - 1] : v[last - 1]);
}

} // namespace

bool isSolid(const b2Fixture& fixture) {
    return !fixture.IsSensor() && (fixture.GetFilterData().maskBits != 0 || fixture.GetFilterData().groupIndex > 0);
}

Outline outlineOf(const b2Fixture& fixture, int32 child, double unitsPerMetre, std::uint32_t key) {
    Outline out;
    out.key = key;
    out.category = fixture.GetFilterData().categoryBits;
    out.mask = fixture.GetFilterData().maskBits;
    out.group = fixture.GetFilterData().groupIndex;
    const ToLocal local{fixture.GetBody()->GetLocalCenter(), unitsPerMetre};
    const b2Shape* shape = fixture.GetShape();
    switch (shape->GetType()) {
    case b2Shape::e_circle: {
        const auto* circle = static_cast<const b2CircleShape*>(shape);
        out.kind = OutlineKind::Circle;
        out.points = {local(circle->m_p)};
        out.radius = static_cast<double>(circle->m_radius) / unitsPerMetre;
        break;
    }
    case b2Shape::e_polygon: {
        const auto* polygon = static_cast<const b2PolygonShape*>(shape);
        out.kind = OutlineKind::Polygon;
        for (int32 i = 0; i < polygon->m_count; ++i)
            out.points.push_back(local(polygon->m_vertices[i]));
        break;
    }
    case b2Shape::e_edge:
        edge(*static_cast<const b2EdgeShape*>(shape), local, out);
        break;
    case b2Shape::e_chain:
        chainEdge(*static_cast<const b2ChainShape*>(shape), child, local, out);
        break;
    case b2Shape::e_typeCount:
        break;
    }
    return out;
}

} // namespace supercircle::bridge
