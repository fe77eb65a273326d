// Stage WriteHost: impulses of the shells and driven poses to the host, before its own step.

#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

namespace supercircle::step {

void writeHost(World& world, Port& port, double advanced) {
    for (Body& b : world.bodies) {
        if (b.driven) {
            port.drive(b.id, b.state.centre - advanced * b.state.velocity, b.state.angle - advanced * b.state.spin,
                       b.state.velocity, b.state.spin);
            continue;
        }
        if (!b.dynamic)
            continue;
        SC_ASSERT(!b.hostCoupling.coupled || b.hostCoupling.coupledTime > 0.0,
                  "a coupled body was solved for some time");
        BodyState now;
        if (!port.state(b.id, now))
            continue;
        if (b.woken && !now.awake)
            port.setAwake(b.id, true);
        b.woken = false;
        const double slow = 1.0 + advanced * now.linearDamping, slowSpin = 1.0 + advanced * now.angularDamping;
        const Vec2 fall = advanced * now.gravityScale * world.gravity;
        HostCoupling& h = b.hostCoupling;
        if (!h.coupled) {
            h.handed = (now.velocity + fall) / slow;
            h.handedSpin = now.spin / slowSpin;
            continue;
        }
        h.handed = h.travel / advanced;
        h.handedSpin = h.turn / advanced;
        const Vec2 impulse = (now.mass * h.handed - h.hostImpulse) * slow - now.mass * (now.velocity + fall);
        const double turn = now.inertia > 0.0
                                ? (now.inertia * h.handedSpin - h.hostTurnImpulse) * slowSpin - now.inertia * now.spin
                                : 0.0;
        port.applyImpulse(b.id, impulse, turn);
    }
}

} // namespace supercircle::step
