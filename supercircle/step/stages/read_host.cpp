// Stage ReadHost: gravity, bodies near the shells, their outlines and constraints, before the first step of a frame.

#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

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

bool finite(const BodyState& s) {
    return s.centre.allFinite() && s.velocity.allFinite() && std::isfinite(s.angle) && std::isfinite(s.spin) &&
           std::isfinite(s.mass) && std::isfinite(s.inertia) && std::isfinite(s.gravityScale) &&
           std::isfinite(s.linearDamping) && std::isfinite(s.angularDamping);
}

void refuse(HostReading& reading, const std::string& what) {
    reading.why += (reading.why.empty() ? "" : "; ") + what;
}

/// Leaves a body out of this frame. One that a joint needs stays where it was last, as an anchor.
bool anchored(const World& world, BodyId id, Body& b) {
    const int index = bodyIndex(world, id);
    const bool joined = std::any_of(world.links.begin(), world.links.end(),
                                    [id](const Link& l) { return l.end == LinkEnd::Body && l.body == id; });
    if (index < 0 || !joined)
        return false;
    const BodyState& last = world.bodies[static_cast<std::size_t>(index)].state;
    b.state = BodyState{};
    b.state.centre = last.centre;
    b.state.angle = last.angle;
    return finite(b.state);
}

void unique(std::vector<BodyId>& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

/// The bodies `reading.ids` (sorted) with fresh states; driven ones keep our pose, known ones what was learnt about
/// them. Those with numbers that are not finite are refused.
void readBodies(const World& world, const Port& port, double frame, HostReading& reading) {
    std::vector<Body>& bodies = reading.bodies;
    bodies.clear();
    for (const BodyId id : reading.ids) {
        Body b;
        b.id = id;
        if (!port.state(id, b.state))
            continue;
        b.driven =
            std::find(world.crossheadBodies.begin(), world.crossheadBodies.end(), id) != world.crossheadBodies.end();
        const bool refused = !b.driven && !finite(b.state);
        if (refused) {
            reading.refused.push_back(id);
            refuse(reading, "body " + std::to_string(id) +
                                ": its position, velocity or mass is not finite; shells ignore it in this frame");
            if (!anchored(world, id, b))
                continue;
        }
        b.dynamic = b.state.mass > 0.0 && b.state.enabled && !b.driven;
        if (const int index = bodyIndex(world, id); index >= 0) {
            const Body& old = world.bodies[static_cast<std::size_t>(index)];
            if (b.driven && old.driven)
                b.state = old.state;
            b.force = old.force;
            if (b.dynamic && !refused && old.hostCoupling.known)
                carryOver(old, frame, b);
        }
        SC_ASSERT(!b.dynamic || b.state.mass > 0.0, "a dynamic body has a mass");
        bodies.push_back(b);
    }
    SC_ASSERT(invariants::strictlyRising(bodies, [](const Body& b) { return b.id; }),
              "bodies are unique, sorted by id");
}

bool isIn(const std::vector<BodyId>& sorted, BodyId id) {
    return std::binary_search(sorted.begin(), sorted.end(), id);
}

/// Constraints of the host on bodies that are refused.
void leaveOut(const std::vector<BodyId>& refused, HostConstraints& constraints) {
    if (refused.empty())
        return;
    const auto concerns = [&](const auto& c) { return isIn(refused, c.a) || isIn(refused, c.b); };
    std::erase_if(constraints.contacts, concerns);
    std::erase_if(constraints.rows, concerns);
}

bool samePoses(const std::vector<Body>& a, const std::vector<Body>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Body& x, const Body& y) {
               return x.id == y.id && x.state.centre == y.state.centre && x.state.angle == y.state.angle &&
                      x.state.velocity == y.state.velocity && x.state.spin == y.state.spin;
           });
}

} // namespace

void readHost(World& world, const Port& port, double frame, HostReading& reading) {
    reading.why.clear();
    reading.refused.clear();
    Vec2 g = port.gravity();
    if (!g.allFinite()) {
        refuse(reading, "gravity is not finite; shells keep that of the last frame");
        g = world.gravity;
    }
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
    clearJoined(reading.joining, outlines);
    const Box read = reach(world, frame);
    if (!world.rods.empty())
        port.query(read, outlines);
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
    readBodies(world, port, frame, reading);
    leaveOut(reading.refused, world.constraints);
    std::erase_if(outlines, [&](const BodyOutline& o) {
        return isIn(reading.refused, o.body) ||
               std::none_of(bodies.begin(), bodies.end(), [&](const Body& b) { return b.id == o.body; });
    });
    joinOutlines(world, port, read, bodies, frame, reading.joining, outlines);
    wakeByHost(world, bodies, outlines, frame);
    if (!std::equal(outlines.begin(), outlines.end(), world.outlines.begin(), world.outlines.end(), sameButSeams) ||
        !samePoses(bodies, world.bodies))
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
