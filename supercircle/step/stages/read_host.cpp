// Stage ReadHost: gravity, bodies near the shells, their outlines and constraints, before the first step of a frame.

#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <limits>

namespace supercircle::step {

namespace {

Box reach(const World& world, double frame) {
    Box box;
    box.lower.setConstant(std::numeric_limits<double>::infinity());
    box.upper.setConstant(-std::numeric_limits<double>::infinity());
    for (const Rod& r : world.rods) {
        const double pad = 2.0 * frame * (r.speed + frame * world.gravity.norm()) + r.model.longestElement();
        for (int i = 0; i <= r.model.elements(); ++i) {
            box.lower = box.lower.cwiseMin(r.kin.node(i) - Vec2::Constant(pad));
            box.upper = box.upper.cwiseMax(r.kin.node(i) + Vec2::Constant(pad));
        }
    }
    return box;
}

/// What the copy `old` of the last frame still knows about a body whose original is now in the state `b.state`.
void carryOver(const Body& old, double frame, Body& b) {
    const BodyState &now = b.state, &seen = old.hostCoupling.seen;
    HostCoupling& h = b.hostCoupling;
    h.unexplained = old.hostCoupling.unexplained;
    h.all = old.hostCoupling.all;
    const bool moved = now.centre != seen.centre || now.angle != seen.angle; // by its user
    if (now.velocity == seen.velocity && now.spin == seen.spin) {
        b.state.velocity = old.state.velocity;
        b.state.spin = old.state.spin;
    }
    if (!moved) {
        h.drift = (now.centre - old.state.centre) / frame;
        h.driftSpin = (now.angle - old.state.angle) / frame;
        b.state.centre = old.state.centre;
        b.state.angle = old.state.angle;
    }
}

void unique(std::vector<BodyId>& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

/// The bodies `ids` (sorted) with fresh states; driven ones keep our pose, known ones what was learnt about them.
void readBodies(const World& world, const Port& port, const std::vector<BodyId>& ids, double frame,
                std::vector<Body>& bodies) {
    bodies.clear();
    for (const BodyId id : ids) {
        Body b;
        b.id = id;
        if (!port.state(id, b.state))
            continue;
        b.driven =
            std::find(world.crossheadBodies.begin(), world.crossheadBodies.end(), id) != world.crossheadBodies.end();
        b.dynamic = b.state.mass > 0.0 && b.state.enabled && !b.driven;
        if (const int index = bodyIndex(world, id); index >= 0) {
            const Body& old = world.bodies[static_cast<std::size_t>(index)];
            if (b.driven && old.driven)
                b.state = old.state;
            b.force = old.force;
            if (b.dynamic && old.hostCoupling.known)
                carryOver(old, frame, b);
        }
        SC_ASSERT(!b.dynamic || b.state.mass > 0.0, "a dynamic body has a mass");
        bodies.push_back(b);
    }
    SC_ASSERT(invariants::strictlyRising(bodies, [](const Body& b) { return b.id; }),
              "bodies are unique, sorted by id");
}

bool samePoses(const std::vector<Body>& a, const std::vector<Body>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Body& x, const Body& y) {
               return x.id == y.id && x.state.centre == y.state.centre && x.state.angle == y.state.angle &&
                      x.state.velocity == y.state.velocity && x.state.spin == y.state.spin;
           });
}

} // namespace

void readHost(World& world, const Port& port, double frame, HostReading& reading) {
    const Vec2 g = port.gravity();
    if (g != world.gravity) { // the potential of the shells is measured anew; that is no work of anybody
        double change = 0.0;
        for (const Rod& r : world.rods)
            change -= r.model.mass() * (g - world.gravity).dot(rod::massCentre(r.kin, r.gauss));
        world.energyBalance.gravity += change;
        world.energyBalance.added += change;
        world.gravity = g;
        wakeAll(world);
    }
    std::vector<BodyOutline>& outlines = reading.outlines;
    std::vector<BodyId>& ids = reading.ids;
    std::vector<Body>& bodies = reading.bodies;
    outlines.clear();
    if (!world.rods.empty())
        port.query(reach(world, frame), outlines);
    ids.assign(world.crossheadBodies.begin(), world.crossheadBodies.end());
    for (const BodyOutline& o : outlines)
        ids.push_back(o.body);
    for (const Link& l : world.links)
        if (l.end == LinkEnd::Body)
            ids.push_back(l.body);
    unique(ids);
    world.constraints.clear();
    port.constraints(ids, frame, world.constraints);
    for (const HostContact& c : world.constraints.contacts)
        ids.insert(ids.end(), {c.a, c.b});
    for (const HostRow& r : world.constraints.rows)
        ids.insert(ids.end(), {r.a, r.b});
    unique(ids);
    readBodies(world, port, ids, frame, bodies);
    std::erase_if(outlines, [&](const BodyOutline& o) {
        return std::none_of(bodies.begin(), bodies.end(), [&](const Body& b) { return b.id == o.body; });
    });
    wakeByHost(world, bodies, outlines, frame);
    if (outlines != world.outlines || !samePoses(bodies, world.bodies))
        world.range.clear();             // candidates refer to outlines by index and to poses
    std::swap(world.outlines, outlines); // the storage of the last frame serves the next one
    std::swap(world.bodies, bodies);
    std::erase_if(world.links, [&](const Link& l) { // as in Box2D: a body takes its joints with it
        const bool gone = l.end == LinkEnd::Body && bodyIndex(world, l.body) < 0;
        if (gone)
            if (const int rod = rodIndex(world, l.rodA); rod >= 0)
                wake(world, static_cast<std::size_t>(rod));
        return gone;
    });
    for (const BodyOutline& o : world.outlines)
        SC_ASSERT(bodyIndex(world, o.body) >= 0, "an outline belongs to a body");
}

} // namespace supercircle::step
