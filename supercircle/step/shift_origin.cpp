// Another origin for everything that has a place. Body frames, arc lengths, impulses and velocities stay.

#include "supercircle/step/world.h"

namespace supercircle::step {

void shiftOrigin(World& world, const Vec2& by) {
    const auto shift = [&](Vec2& place) { place -= by; };
    const auto shiftTarget = [&](Target& t) {
        shift(t.point);
        shift(t.path.from);
        shift(t.path.to);
    };
    for (Rod& r : world.rods) {
        for (Eigen::VectorXd* q : {&r.q, &r.lastAccepted})
            q->segment<2>(r.model.dofX()) -= by;
        const std::vector<Vec2> u = r.u;
        const double speed = r.speed;
        refreshRod(r);
        r.speed = speed;
        r.u = u; // carried momentum is more than J v knows
        for (Vec2& place : r.stillReference)
            shift(place);
        for (Hold& h : r.holds)
            shiftTarget(h.target);
        for (MouseJoint& g : r.mouseJoints)
            shift(g.target);
        const double change = r.model.mass() * world.gravity.dot(by); // of -m g . x
        world.energyBalance.gravity += change;
        world.energyBalance.added += change;
    }
    for (Link& l : world.links)
        shiftTarget(l.target);
    for (Body& b : world.bodies) {
        shift(b.state.centre);
        shift(b.hostCoupling.seen.centre);
        shift(b.stillCentre);
    }
    world.candidates.clear();
    world.range.clear();
}

} // namespace supercircle::step
