#include "supercircle/step/carry_along.h"

#include "supercircle/step/coupling/host_coupling.h"
#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::step {

namespace {

bool samePlace(const BodyState& a, const BodyState& b) {
    return a.centre == b.centre && a.angle == b.angle;
}

/// Whether its user has put the body somewhere else, so that it is there at once.
bool isMoved(const World& world, const Body& old, const BodyState& now) {
    if (now.mass > 0.0 && now.enabled)
        return old.yields() && old.hostCoupling.known && !samePlace(now, old.hostCoupling.seen);
    return !old.dynamic && isJump(old.state, now, thinnest(world), farthestPoint(world, world.outlines, old.id));
}

/// The rods that joints tie to rod `first`, itself included, sorted; empty if something besides `body` ties them too.
std::vector<std::size_t> joinedAlone(const World& world, std::size_t first, BodyId body) {
    std::vector<std::size_t> rods{first};
    for (std::size_t k = 0; k < rods.size(); ++k) {
        const Rod& rod = world.rods[rods[k]];
        if (!rod.holds.empty())
            return {};
        for (const Link& l : world.links) {
            const bool isA = l.rodA == rod.key, isB = l.end == LinkEnd::Rod && l.rodB == rod.key;
            if ((isA && l.end == LinkEnd::World) || (isA && l.end == LinkEnd::Body && l.body != body))
                return {};
            if (l.end != LinkEnd::Rod || isA == isB)
                continue;
            const int other = rodIndex(world, isA ? l.rodB : l.rodA);
            SC_ASSERT(other >= 0, "a joint has both its shells");
            if (std::find(rods.begin(), rods.end(), static_cast<std::size_t>(other)) == rods.end())
                rods.push_back(static_cast<std::size_t>(other));
        }
    }
    std::sort(rods.begin(), rods.end());
    return rods;
}

} // namespace

void carryAlong(World& world, const Port& port, HostReading& reading) {
    std::vector<BodyId>& jumped = reading.jumped;
    jumped.clear();
    reading.carried.clear();
    const auto carried = [&](std::uint32_t key) {
        return std::find(reading.carried.begin(), reading.carried.end(), key) != reading.carried.end();
    };
    for (std::size_t i = 0; i < world.links.size(); ++i) {
        const Link& l = world.links[i];
        const int index = l.end == LinkEnd::Body ? bodyIndex(world, l.body) : -1;
        const int rod = rodIndex(world, l.rodA);
        BodyState now;
        if (index < 0 || rod < 0 || carried(l.rodA) || !port.state(l.body, now) || !finite(now))
            continue;
        const Body& old = world.bodies[static_cast<std::size_t>(index)];
        if (old.driven || !isMoved(world, old, now))
            continue;
        jumped.push_back(l.body);
        BodyState to = now; // as carryOver: a velocity its user has not changed is that of our copy
        if (old.dynamic && now.velocity == old.hostCoupling.seen.velocity && now.spin == old.hostCoupling.seen.spin) {
            to.velocity = old.state.velocity;
            to.spin = old.state.spin;
        }
        for (const std::size_t k : joinedAlone(world, static_cast<std::size_t>(rod), l.body)) {
            carryRod(world, k, old.state, to);
            reading.carried.push_back(world.rods[k].key);
        }
    }
    std::sort(jumped.begin(), jumped.end());
}

void meetBody(World& world, BodyId id, const BodyState& now) {
    const int index = bodyIndex(world, id);
    if (index < 0) {
        Body b;
        b.id = id;
        b.state = b.hostCoupling.seen = now;
        b.dynamic = b.hostCoupling.known = now.mass > 0.0 && now.enabled;
        world.bodies.insert(std::lower_bound(world.bodies.begin(), world.bodies.end(), id,
                                             [](const Body& x, BodyId want) { return x.id < want; }),
                            b);
        return;
    }
    Body& b = world.bodies[static_cast<std::size_t>(index)];
    if (b.driven || !isMoved(world, b, now))
        return;
    b.state.centre = b.hostCoupling.seen.centre = now.centre;
    b.state.angle = b.hostCoupling.seen.angle = now.angle;
    wakeAll(world); // those that lie on it would not notice
}

} // namespace supercircle::step
