#include "supercircle/step/contacts/cull.h"

#include "supercircle/step/contact_memory.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

/// Of a point of the centre line, from the velocities at the Gauss points beside it.
Vec2 velocityAt(const Rod& rod, const contact::RodPoint& at) {
    const rod::MaterialPoint place = rod::locate(rod.model, at.element, at.s);
    const rod::Segment& segment = rod.model.side(place.side)[static_cast<std::size_t>(place.segment)];
    const double f = segment.signedLength != 0.0 ? place.local / segment.signedLength : 0.0;
    const std::size_t first =
        static_cast<std::size_t>(rod::RodModel::kGauss) *
        (static_cast<std::size_t>(place.segment) + (place.side == 0 ? 0 : rod.model.side(0).size()));
    int k = 0;
    while (k + 2 < rod::RodModel::kGauss && f > rod::RodModel::kGaussNode[k + 1])
        ++k;
    const double low = rod::RodModel::kGaussNode[k], high = rod::RodModel::kGaussNode[k + 1];
    const double share = (f - low) / (high - low);
    return (1.0 - share) * rod.u[first + static_cast<std::size_t>(k)] +
           share * rod.u[first + static_cast<std::size_t>(k) + 1];
}

/// The same with what gravity adds within the step; of sleepers and other frozen rods nothing.
Vec2 velocityOf(const World& world, const contact::RodPoint& at, const Vec2& fall) {
    const Rod& rod = world.rods[static_cast<std::size_t>(at.rod)];
    return rod.frozen() ? Vec2(Vec2::Zero()) : Vec2(velocityAt(rod, at) + fall);
}

/// Of a point of a body's surface; a body that disappeared stands still.
Vec2 velocityOf(const World& world, const contact::Candidate& c, double dt) {
    const BodyId id = world.outlines[static_cast<std::size_t>(c.outline)].body;
    const int index = bodyIndex(world, id);
    if (index < 0)
        return Vec2::Zero();
    const Body& body = world.bodies[static_cast<std::size_t>(index)];
    const Vec2 fall = body.dynamic ? Vec2(dt * body.state.gravityScale * world.gravity) : Vec2::Zero();
    return body.state.velocity + fall + body.state.spin * rod::perp(c.pointB - body.state.centre);
}

} // namespace

void cull(const World& world, double dt, double slack, const std::vector<contact::Candidate>& all,
          std::vector<contact::Candidate>& kept) {
    SC_ASSERT(dt > 0.0 && !(slack < 0.0), "a step takes time");
    kept.clear();
    const Vec2 fall = dt * world.gravity;
    for (const contact::Candidate& c : all) {
        const Vec2 a = velocityOf(world, c.a, fall);
        const Vec2 b = c.b.rod >= 0 ? velocityOf(world, c.b, fall) : velocityOf(world, c, dt);
        const Vec2 relative = a - b;
        // Approach along the normal, and what the normal may turn into on the way.
        const double approach = dt * (std::max(0.0, -c.normal.dot(relative)) + 0.25 * relative.norm());
        if (c.gap <= slack + approach || findImpulse(world.impulses, c.id))
            kept.push_back(c);
    }
    SC_ASSERT(kept.size() <= all.size(), "a part of the candidates");
}

} // namespace supercircle::step
