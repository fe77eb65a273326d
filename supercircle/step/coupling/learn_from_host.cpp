// After the host's own step: what its constraints did to the bodies.

#include "supercircle/step/coupling/sleeping_bodies.h"
#include "supercircle/step/coupling/stray_bodies.h"
#include "supercircle/step/crush.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

void learnFromHost(World& world, const Settings& settings, const PairFilter& filter, Port& port, double advanced,
                   HostCouplingWork& work) {
    if (!(advanced > 0.0))
        return;
    resumeInHost(world, port);
    port.impulses(advanced, world.constraints);
    // A body that the host has lost to bad numbers must not spoil its neighbours.
    std::erase_if(world.constraints.contacts,
                  [](const HostContact& c) { return !std::isfinite(c.hostNormal) || !std::isfinite(c.hostTangent); });
    std::erase_if(world.constraints.rows, [](const HostRow& r) { return !std::isfinite(r.host); });
    wakeWoken(world, port, advanced, work);
    unsolvedByHost(world, port, advanced, work);
    const std::vector<BodyMotion>& unsolved = work.unsolved;
    SC_ASSERT(unsolved.size() == world.bodies.size(), "one motion a body");
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        Body& b = world.bodies[i];
        HostCoupling& h = b.hostCoupling;
        BodyState now;
        if (b.asleep())
            continue;
        h.known = b.dynamic && port.state(b.id, now) && now.centre.allFinite() && now.velocity.allFinite() &&
                  std::isfinite(now.angle) && std::isfinite(now.spin);
        if (!h.known) {
            if (b.island != 0)
                work.struck.push_back(b.island);
            continue;
        }
        if (h.coupled && !now.awake && isStruck(world, settings, b, h.handed, h.handedSpin, advanced)) {
            // The host takes it for resting, but its shells move.
            now.velocity = h.handed + unsolved[i].velocity;
            now.spin = h.handedSpin + unsolved[i].spin;
            port.setAwake(b.id, true);
        }
        const Vec2 change = now.velocity - h.handed - unsolved[i].velocity;
        const double turn = now.spin - h.handedSpin - unsolved[i].spin;
        const BodyState& s = b.state;
        if (b.island != 0) { // copies in no contact problem were told what to expect by `all`
            const Vec2 surprise = h.coupled ? change : Vec2(now.velocity - s.velocity);
            if (isStruck(world, settings, b, surprise, h.coupled ? turn : now.spin - s.spin, advanced))
                work.struck.push_back(b.island);
        }
        // `handed` holds what was expected of the host for coupled copies only; of others all of it is in `change`.
        const Vec2 expected = h.coupled ? Vec2(h.hostImpulse / s.mass) : Vec2(Vec2::Zero());
        const double expectedTurn = h.coupled && s.inertia > 0.0 ? h.hostTurnImpulse / s.inertia : 0.0;
        h.all.learn((expected + change) / advanced, (expectedTurn + turn) / advanced, advanced);
        h.unexplained.learn(h.coupled ? Vec2(change / advanced + h.unexplained.expectedLinear) : Vec2(Vec2::Zero()),
                            h.coupled ? turn / advanced + h.unexplained.expectedAngular : 0.0, advanced);
        if (h.coupled) {
            b.state.velocity += change;
            b.state.spin += turn;
            port.setVelocity(b.id, b.state.velocity, b.state.spin);
        } else {
            b.state.velocity = now.velocity;
            b.state.spin = now.spin;
        }
        (void)port.state(b.id, h.seen); // it answered above
    }
    putBackStrays(world, filter, port, work);
    reconcilePoses(world, filter, port, advanced, work);
    settleBodies(world, settings, port, advanced, work);
    world.constraints.clear(); // names the host's addresses: nothing to keep between frames
}

} // namespace supercircle::step
