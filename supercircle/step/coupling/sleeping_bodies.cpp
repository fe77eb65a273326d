#include "supercircle/step/coupling/sleeping_bodies.h"

#include "supercircle/step/islands/reach.h"
#include "supercircle/step/sleep.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

bool moves(const BodyState& s) {
    return !s.velocity.isZero(0.0) || s.spin != 0.0;
}

bool holdMoves(const World& world, const Rod& rod) {
    return std::any_of(rod.holds.begin(), rod.holds.end(), [&](const Hold& h) {
        return h.onCrosshead ? !world.crossheadVelocity.isZero(0.0) : h.target.moving();
    });
}

/// Whether the host or its user has done something to a sleeper since it was seen last.
bool isChanged(const Body& b, const Port& port) {
    BodyState now;
    if (!port.state(b.id, now))
        return true;
    const BodyState& seen = b.hostCoupling.seen;
    return now.awake || now.enabled != seen.enabled || now.maySleep != seen.maySleep || now.centre != seen.centre ||
           now.angle != seen.angle || now.mass != seen.mass || now.inertia != seen.inertia ||
           now.gravityScale != seen.gravityScale || moves(now);
}

} // namespace

void wakeBody(Body& b) {
    b.island = 0;
    b.stillTime = 0.0;
    b.dynamic = b.state.mass > 0.0 && b.state.enabled && !b.driven;
    b.woken = true;
}

void wakeChanged(World& world, const Port& port) {
    for (const Body& b : world.bodies)
        if (b.island != 0 && isChanged(b, port))
            wakeIsland(world, b.island); // changes this list's bodies only in place
}

void sleepOn(const Body& old, double frame, Body& b) {
    SC_ASSERT(old.asleep(), "it fell asleep in a frame before");
    b.dynamic = false;
    b.island = old.island;
    b.state.centre = old.state.centre;
    b.state.angle = old.state.angle;
    b.state.velocity = old.state.velocity;
    b.state.spin = old.state.spin;
    b.hostCoupling.unexplained = old.hostCoupling.unexplained.during(frame);
    b.hostCoupling.all = old.hostCoupling.all.during(frame);
    b.hostCoupling.known = old.hostCoupling.known;
    b.hostCoupling.seen = old.hostCoupling.seen;
}

void wakeTouched(World& world, const std::vector<Body>& bodies, const std::vector<BodyOutline>& outlines,
                 const std::vector<Box>& regions) {
    if (std::none_of(bodies.begin(), bodies.end(), [](const Body& b) { return b.asleep(); }))
        return;
    const auto touches = [&](const Body* sleeper, const Body* other) {
        if (sleeper != nullptr && other != nullptr && sleeper->asleep() && (other->dynamic || moves(other->state)))
            wakeIsland(world, sleeper->island);
    };
    const auto meet = [&](const auto& constraint) {
        const Body *a = findBody(bodies, constraint.a), *b = findBody(bodies, constraint.b);
        touches(a, b);
        touches(b, a);
    };
    std::for_each(world.constraints.contacts.begin(), world.constraints.contacts.end(), meet);
    std::for_each(world.constraints.rows.begin(), world.constraints.rows.end(), meet);
    for (const Link& l : world.links)
        if (const Body* b = l.end == LinkEnd::Body ? findBody(bodies, l.body) : nullptr; b != nullptr && b->asleep())
            if (const int rod = rodIndex(world, l.rodA);
                rod >= 0 && world.rods[static_cast<std::size_t>(rod)].island != b->island)
                wakeIsland(world, b->island);
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (!world.rods[i].frozen() && holdMoves(world, world.rods[i])) // what it meets cannot push it back
            for (const BodyOutline& o : outlines)
                if (const Body* b = findBody(bodies, o.body);
                    b != nullptr && b->asleep() && step::meet(regions[i], reachOf(world, b->state, o, 0.0)))
                    wakeIsland(world, b->island);
}

void wakeAsBefore(const std::vector<Body>& old, std::vector<Body>& bodies) {
    for (Body& b : bodies)
        if (const Body* was = b.island != 0 ? findBody(old, b.id) : nullptr; was != nullptr && was->island == 0)
            wakeBody(b);
}

void keepHostImpulse(Body& b, double dt) {
    HostCoupling& h = b.hostCoupling;
    h.hostImpulse += dt * b.state.mass * h.all.linear;
    h.hostTurnImpulse += dt * b.state.inertia * h.all.angular;
}

void wakeWoken(World& world, const Port& port, double advanced, HostCouplingWork& work) {
    work.woken.clear();
    std::vector<std::uint32_t>& islands = work.struck;
    islands.clear();
    BodyState now;
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (const Body& b = world.bodies[i]; b.asleep() && port.state(b.id, now) && now.awake) {
            islands.push_back(b.island);
            work.woken.push_back(static_cast<int>(i));
        }
    for (Body& b : world.bodies)
        if (b.asleep() && std::find(islands.begin(), islands.end(), b.island) != islands.end()) {
            b.hostCoupling.coupled = true; // nothing was to happen to them
            b.hostCoupling.handed.setZero();
            b.hostCoupling.handedSpin = 0.0;
        }
    for (const int i : work.woken) // all that the host's constraints did stands for what they do at rest
        world.bodies[static_cast<std::size_t>(i)].hostCoupling.coupledTime = advanced;
    for (const std::uint32_t island : islands)
        wakeIsland(world, island);
    islands.clear();
}

bool isStruck(const World& world, const Settings& settings, const Body& b, const Vec2& velocity, double spin,
              double advanced) {
    const double reach = farthestPoint(world, world.outlines, b.id);
    const double way = (velocity.norm() + std::abs(spin) * reach) * std::max(settings.sleepAfter, advanced);
    return !(way <= settings.sleepDrift * b.thicknessNear);
}

namespace {

void measureRest(const World& world, const Settings& settings, double dt, Body& b) {
    const double reach = farthestPoint(world, world.outlines, b.id);
    const double way = (b.state.centre - b.stillCentre).norm() + std::abs(b.state.angle - b.stillAngle) * reach;
    const bool stayed = b.stillTime > 0.0 && way <= settings.sleepDrift * b.thicknessNear;
    if (!stayed) {
        b.stillCentre = b.state.centre;
        b.stillAngle = b.state.angle;
    }
    b.stillTime = stayed ? b.stillTime + dt : dt;
}

/// A body without mass that lies under a sleeper: while the host keeps it awake it wakes what touches it.
void letSupportsSleep(const World& world, Port& port) {
    const auto add = [&](const auto& constraint) {
        const int a = bodyIndex(world, constraint.a), b = bodyIndex(world, constraint.b);
        if (a < 0 || b < 0)
            return;
        const Body &bodyA = world.bodies[static_cast<std::size_t>(a)],
                   &bodyB = world.bodies[static_cast<std::size_t>(b)];
        if (bodyA.asleep() != bodyB.asleep())
            if (const Body& support = bodyA.asleep() ? bodyB : bodyA;
                !support.dynamic && support.state.moving && !moves(support.state))
                port.setAwake(support.id, false);
    };
    std::for_each(world.constraints.contacts.begin(), world.constraints.contacts.end(), add);
    std::for_each(world.constraints.rows.begin(), world.constraints.rows.end(), add);
}

} // namespace

void settleBodies(World& world, const Settings& settings, Port& port, double advanced, const HostCouplingWork& work) {
    if (settings.autoSleep)
        for (Body& b : world.bodies)
            if (b.dynamic)
                measureRest(world, settings, advanced, b);
    for (const std::uint32_t island : work.struck)
        wakeIsland(world, island);
    bool any = false;
    for (Body& b : world.bodies) {
        if (!b.dynamic || b.island == 0)
            continue;
        b.dynamic = false;
        b.woken = false;
        b.state.velocity.setZero();
        b.state.spin = 0.0;
        b.hostCoupling.coupled = false;
        b.hostCoupling.drift.setZero();
        b.hostCoupling.driftSpin = 0.0;
        port.setAwake(b.id, false);
        (void)port.state(b.id, b.hostCoupling.seen); // it answered after this step
        any = true;
    }
    if (any)
        letSupportsSleep(world, port);
}

} // namespace supercircle::step
