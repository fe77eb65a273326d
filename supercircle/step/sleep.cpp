#include "supercircle/step/sleep.h"

#include "supercircle/contact/feature_id.h"
#include "supercircle/step/contact_memory.h"
#include "supercircle/step/coupling/sleeping_bodies.h"
#include "supercircle/step/islands/reach.h"
#include "supercircle/step/stages/join_outlines.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace supercircle::step {

namespace {

/// Moves the entries whose first rod is asleep (or awake) from one list to the other.
void moveImpulses(const World& world, bool asleep, std::vector<ContactImpulse>& from, std::vector<ContactImpulse>& to) {
    const auto leaves = [&](const ContactImpulse& c) {
        const int rod = rodIndex(world, contact::keyAOf(c.id));
        return rod >= 0 && world.rods[static_cast<std::size_t>(rod)].asleep() == asleep;
    };
    const std::size_t before = to.size();
    std::copy_if(from.begin(), from.end(), std::back_inserter(to), leaves);
    if (to.size() == before)
        return;
    const std::size_t all = from.size() + before;
    std::erase_if(from, leaves);
    sortById(to);
    SC_ASSERT(from.size() + to.size() == all, "no contact force is lost or doubled");
}

/// Box of an outline from where it is to where its body takes it.
Box reachOf(const BodyOutline& o, const Body& b, double frame, const Vec2& gravity) {
    const contact::Outline now = placed(o, b.state.centre, b.state.angle);
    double size = 0.0;
    for (const Vec2& p : o.local.points)
        size = std::max(size, p.norm() + o.local.radius);
    const double fall = b.dynamic ? frame * std::abs(b.state.gravityScale) * gravity.norm() : 0.0;
    const double way = frame * (b.state.velocity.norm() + fall + std::abs(b.state.spin) * size) + o.local.radius;
    Box box = emptyBox();
    for (const Vec2& p : now.points)
        widen(box, p, way);
    return box;
}

/// Where bodies wake a rod: its arcs lie within half an element of their nodes.
Box boxOf(const Rod& rod) {
    const double pad = 0.5 * rod.model.longestElement() + rod.model.definition().thickness;
    Box own = emptyBox();
    for (int i = 0; i <= rod.model.elements(); ++i)
        widen(own, rod.kin.node(i), pad);
    return own;
}

/// What hangs together, and what keeps it awake.
struct SleepIslands {
    std::vector<std::size_t> parent; ///< of the rods, then of the bodies
    std::vector<const char*> busy;   ///< per root: why it cannot sleep, or null

    std::size_t root(std::size_t i) {
        SC_ASSERT(i < parent.size(), "a rod or body of the world");
        while (parent[i] != i)
            i = parent[i] = parent[parent[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        a = root(a);
        b = root(b);
        if (a == b)
            return;
        if (!busy[a])
            busy[a] = busy[b];
        parent[b] = a;
    }
    void keepAwake(std::size_t i, const char* why) {
        const char*& reason = busy[root(i)];
        if (!reason)
            reason = why;
    }
};

bool moves(const Body& b) {
    return !b.state.velocity.isZero(0.0) || b.state.spin != 0.0;
}

void addBody(const World& world, int rod, BodyId id, SleepIslands& islands) {
    const int i = bodyIndex(world, id);
    if (rod < 0 || i < 0)
        return;
    const Body& b = world.bodies[static_cast<std::size_t>(i)];
    if (b.dynamic)
        islands.join(static_cast<std::size_t>(rod), world.rods.size() + static_cast<std::size_t>(i));
    else if (moves(b))
        islands.keepAwake(static_cast<std::size_t>(rod), "it touches or is joined to a moving body");
}

/// What the host's own contacts and joints hang together.
void addHostConstraints(const World& world, SleepIslands& islands) {
    const auto add = [&](BodyId idA, BodyId idB) {
        const int a = bodyIndex(world, idA), b = bodyIndex(world, idB);
        if (a < 0 || b < 0)
            return;
        const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b), rods = world.rods.size();
        const Body &bodyA = world.bodies[ia], &bodyB = world.bodies[ib];
        if (bodyA.dynamic && bodyB.dynamic)
            islands.join(rods + ia, rods + ib);
        else if (bodyA.dynamic ? moves(bodyB) : bodyB.dynamic && moves(bodyA))
            islands.keepAwake(rods + (bodyA.dynamic ? ia : ib), "a body on it touches or is joined to a moving one");
    };
    for (const HostContact& c : world.constraints.contacts)
        add(c.a, c.b);
    for (const HostRow& r : world.constraints.rows)
        add(r.a, r.b);
}

void addLinks(const World& world, SleepIslands& islands) {
    for (const Link& l : world.links) {
        const int a = rodIndex(world, l.rodA), b = l.end == LinkEnd::Rod ? rodIndex(world, l.rodB) : -1;
        if (a < 0)
            continue;
        const auto ia = static_cast<std::size_t>(a);
        if (b >= 0)
            islands.join(ia, static_cast<std::size_t>(b));
        if (l.end == LinkEnd::Body)
            addBody(world, a, l.body, islands);
        if ((l.end == LinkEnd::World && l.target.moving()) || (l.kind == LinkKind::Tether && l.goal != l.length))
            islands.keepAwake(ia, "it is joined to something that moves");
    }
}

SleepIslands findIslands(const World& world) {
    SleepIslands islands;
    islands.parent.resize(world.rods.size() + world.bodies.size());
    std::iota(islands.parent.begin(), islands.parent.end(), std::size_t{0});
    islands.busy.assign(islands.parent.size(), nullptr);
    for (const contact::Candidate& c : world.candidates) {
        if (!findImpulse(world.impulses, c.id))
            continue;
        if (c.b.rod >= 0)
            islands.join(static_cast<std::size_t>(c.a.rod), static_cast<std::size_t>(c.b.rod));
        else
            addBody(world, c.a.rod, world.outlines[static_cast<std::size_t>(c.outline)].body, islands);
    }
    addLinks(world, islands);
    addHostConstraints(world, islands);
    for (const Overlap& o : world.overlaps) {
        const int a = rodIndex(world, o.rodA), b = o.rodB != 0 ? rodIndex(world, o.rodB) : -1;
        if (a >= 0 && b >= 0)
            islands.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
        else
            addBody(world, a, o.body, islands);
    }
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        for (const Hold& h : world.rods[i].holds) {
            if (h.onCrosshead ? !world.crossheadVelocity.isZero(0.0) : h.target.moving())
                islands.keepAwake(i, "one of its holds moves");
        }
    return islands;
}

/// Bodies that would wake a rod beside them (wakeByHost) as they tremble: of two neighbours that rest, each would wake
/// the other one for ever.
void addNeighbours(const World& world, double frame, SleepIslands& islands) {
    std::vector<Box> boxes;
    for (const BodyOutline& o : world.outlines) {
        const int i = bodyIndex(world, o.body);
        SC_ASSERT(i >= 0, "an outline belongs to a body");
        const Body& b = world.bodies[static_cast<std::size_t>(i)];
        if (!b.dynamic)
            continue;
        if (boxes.empty())
            for (const Rod& r : world.rods)
                boxes.push_back(boxOf(r));
        const Box reach = reachOf(o, b, frame, world.gravity);
        for (std::size_t rod = 0; rod < boxes.size(); ++rod)
            if (!world.rods[rod].frozen() && meet(boxes[rod], reach))
                islands.join(rod, world.rods.size() + static_cast<std::size_t>(i));
    }
}

/// Stops a rod; its kinetic energy leaves the energy balance for `account`.
void stop(World& world, Rod& rod, double& account, double sign) {
    const double kinetic = rod::kineticEnergy(rod.gauss, rod.u);
    world.energyBalance.kinetic -= kinetic;
    account += sign * kinetic;
    rod.v.setZero();
    std::fill(rod.u.begin(), rod.u.end(), Vec2::Zero());
    rod.speed = 0.0;
    SC_ASSERT(!rod.frozen(), "a rod that moved until now");
}

void settle(World& world) {
    moveImpulses(world, true, world.impulses, world.sleepingImpulses);
    world.range.clear();
}

} // namespace

void wakeIsland(World& world, std::uint32_t island) {
    if (island == 0)
        return;
    for (Rod& r : world.rods)
        if (r.island == island) {
            r.island = 0;
            r.stillTime = 0.0;
        }
    for (Body& b : world.bodies)
        if (b.island == island)
            wakeBody(b);
    moveImpulses(world, false, world.sleepingImpulses, world.impulses);
    world.range.clear();
}

void wake(World& world, std::size_t rod) {
    SC_ASSERT(rod < world.rods.size(), "a rod of the world");
    wakeIsland(world, world.rods[rod].island);
    world.rods[rod].stillTime = 0.0;
}

void wakeAll(World& world) {
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        wake(world, i);
}

std::string putToSleep(World& world, std::size_t rod) {
    SC_ASSERT(rod < world.rods.size(), "a rod of the world");
    if (world.rods[rod].frozen())
        return {};
    if (world.range.size() != world.rods.size())
        return "its contacts are not known yet: call it after the next step";
    SleepIslands islands = findIslands(world);
    const std::size_t root = islands.root(rod);
    if (islands.busy[root])
        return islands.busy[root];
    for (std::size_t i = world.rods.size(); i < islands.parent.size(); ++i)
        if (islands.root(i) == root)
            return "it carries or is joined to a dynamic body";
    const std::uint32_t island = world.nextIsland++;
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (islands.root(i) == root && !world.rods[i].frozen()) {
            stop(world, world.rods[i], world.energyBalance.added, -1.0);
            world.rods[i].island = island;
        }
    settle(world);
    return {};
}

void measureRest(World& world, const Settings& settings, double dt) {
    SC_ASSERT(dt > 0.0, "a step takes time");
    for (Rod& r : world.rods) {
        const double farthest = settings.sleepDrift * lengthOf(r, settings.length);
        const std::array<Vec2, 3> now{r.kin.node(0), r.kin.middle(), r.kin.node(r.model.elements())};
        const bool stayed =
            r.stillTime > 0.0 && std::equal(now.begin(), now.end(), r.stillReference.begin(),
                                            [&](const Vec2& a, const Vec2& b) { return (a - b).norm() <= farthest; });
        if (!stayed)
            r.stillReference = now;
        r.stillTime = stayed ? r.stillTime + dt : dt;
    }
}

void sleepAtRest(World& world, const Settings& settings, double frame) {
    const auto tired = [&](const Rod& r) { return !r.frozen() && r.stillTime >= settings.sleepAfter; };
    if (world.range.size() != world.rods.size() || std::none_of(world.rods.begin(), world.rods.end(), tired))
        return;
    SleepIslands islands = findIslands(world);
    addNeighbours(world, frame, islands);
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (!world.rods[i].frozen() && !tired(world.rods[i]))
            islands.keepAwake(i, "it moves");
    for (const Overlap& o : world.overlaps)
        if (const int rod = rodIndex(world, o.rodA); rod >= 0)
            islands.keepAwake(static_cast<std::size_t>(rod), "it overlaps something");
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (const Body& b = world.bodies[i]; b.dynamic && !(b.state.maySleep && b.stillTime >= settings.sleepAfter))
            islands.keepAwake(world.rods.size() + i, "a body on it moves or may not sleep");
    std::vector<std::uint32_t> number(islands.parent.size(), 0);
    bool any = false;
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        Rod& r = world.rods[i];
        const std::size_t root = islands.root(i);
        if (islands.busy[root] || r.frozen())
            continue;
        if (number[root] == 0)
            number[root] = world.nextIsland++;
        stop(world, r, world.energyBalance.numerical, 1.0);
        r.island = number[root];
        any = true;
    }
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        if (Body& b = world.bodies[i]; b.dynamic)
            b.island = number[islands.root(world.rods.size() + i)];
    if (any)
        settle(world);
    SC_ASSERT_EXPENSIVE(std::all_of(world.rods.begin(), world.rods.end(),
                                    [&](const Rod& r) {
                                        const auto i = static_cast<std::size_t>(&r - world.rods.data());
                                        return r.frozen() || islands.busy[islands.root(i)] != nullptr;
                                    }),
                        "an island falls asleep as a whole");
}

namespace {

bool samePose(const Body& a, const Body& b) {
    return a.state.centre == b.state.centre && a.state.angle == b.state.angle;
}

} // namespace

void wakeByHost(World& world, const std::vector<Body>& bodies, const std::vector<BodyOutline>& outlines, double frame) {
    if (std::none_of(world.rods.begin(), world.rods.end(), [](const Rod& r) { return r.asleep(); }))
        return;
    const auto wakeIn = [&](const Box& box) {
        for (std::size_t i = 0; i < world.rods.size(); ++i)
            if (world.rods[i].asleep() && meet(boxOf(world.rods[i]), box))
                wake(world, i);
    };
    // Both lists are sorted by (body, key): walk them together.
    const std::vector<BodyOutline>& old = world.outlines;
    std::size_t i = 0, j = 0;
    while (i < old.size() || j < outlines.size()) {
        const bool gone = j == outlines.size() || (i < old.size() && before(old[i], outlines[j]));
        const bool fresh = !gone && (i == old.size() || before(outlines[j], old[i]));
        const Body* was = i < old.size() && !fresh ? findBody(world.bodies, old[i].body) : nullptr;
        const Body* is = !gone ? findBody(bodies, outlines[j].body) : nullptr;
        // Vertices are joined anew where bodies have moved against each other in the frame before.
        const bool still = was && is && samePose(*was, *is) && !moves(*is) &&
                           sameButSeams(old[i], outlines[j], contact::kSeamTolerance * is->thicknessNear);
        if (!still) {
            if (was)
                wakeIn(reachOf(old[i], *was, frame, world.gravity));
            if (is)
                wakeIn(reachOf(outlines[j], *is, frame, world.gravity));
        }
        i += fresh ? 0 : 1;
        j += gone ? 0 : 1;
    }
}

} // namespace supercircle::step
