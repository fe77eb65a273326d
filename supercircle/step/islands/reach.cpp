#include "supercircle/step/islands/reach.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/support/invariants.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

Box emptyBox() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {Vec2::Constant(infinity), Vec2::Constant(-infinity)};
}

void widen(Box& box, const Box& other) {
    box.lower = box.lower.cwiseMin(other.lower);
    box.upper = box.upper.cwiseMax(other.upper);
}

void widen(Box& box, const Vec2& point, double pad) {
    box.lower = box.lower.cwiseMin(point - Vec2::Constant(pad));
    box.upper = box.upper.cwiseMax(point + Vec2::Constant(pad));
}

bool meet(const Box& a, const Box& b) {
    return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

bool contains(const Box& outer, const Box& inner) {
    return (outer.lower.array() <= inner.lower.array()).all() && (inner.upper.array() <= outer.upper.array()).all();
}

double surfaceReach(const Rod& rod) {
    const double element = rod.model.longestElement(), h = rod.model.definition().thickness;
    return std::max(0.5 * element, 0.25 * element + 0.75 * h);
}

Box reachOf(const World& world, const Rod& rod, const rod::Kinematics& kin, double speed, double frame) {
    Box box = emptyBox();
    const effects::Adhesion& pull = rod.effects.adhesion;
    const double way = std::max(2.0 * frame * (speed + frame * world.gravity.norm()), wayOfHolds(rod, frame));
    const double pad = way + 2.0 * surfaceReach(rod) + (pull.on() ? pull.model.range : 0.0);
    for (int i = 0; i <= rod.model.elements(); ++i)
        widen(box, kin.node(i), pad);
    return box;
}

Box reachOf(const World& world, const BodyState& b, const BodyOutline& piece, double frame) {
    const double c = math::cos(b.angle), s = math::sin(b.angle), fall = frame * world.gravity.norm();
    Box box = emptyBox();
    for (const Vec2& p : piece.local.points)
        widen(box, b.centre + Vec2(c * p.x() - s * p.y(), s * p.x() + c * p.y()),
              piece.local.radius + 2.0 * frame * (b.velocity.norm() + std::abs(b.spin) * p.norm() + fall));
    return box;
}

Box reachOf(const World& world, const BodyOutline& piece, double frame) {
    const int index = bodyIndex(world, piece.body);
    SC_ASSERT(index >= 0, "an outline belongs to a body");
    const Body& b = world.bodies[static_cast<std::size_t>(index)];
    BodyState state = b.state;
    state.velocity += b.hostCoupling.drift;
    state.spin += b.hostCoupling.driftSpin;
    return reachOf(world, state, piece, frame);
}

} // namespace supercircle::step
