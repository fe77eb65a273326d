// Stage ReadHost: gravity, bodies near the shells, their outlines and constraints, before the first step of a frame.

#include "supercircle/step/carry_along.h"
#include "supercircle/step/contacts/gap_closing.h"
#include "supercircle/step/coupling/host_coupling.h"
#include "supercircle/step/coupling/sleeping_bodies.h"
#include "supercircle/step/crush.h"
#include "supercircle/step/islands/reach.h"
#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>

namespace supercircle::step {

namespace {

Box hull(const std::vector<Box>& boxes) {
    Box all = emptyBox();
    for (const Box& b : boxes)
        widen(all, b);
    return all;
}

/// Whether the rod at `kin` may meet an outline that was not read.
bool outside(const Rod& r, const rod::Kinematics& kin, const Box& region) {
    const double bulge = surfaceReach(r);
    for (int i = 0; i <= r.model.elements(); ++i) {
        const Vec2 p = kin.node(i);
        if (((p.array() - bulge) < region.lower.array()).any() || ((p.array() + bulge) > region.upper.array()).any())
            return true;
    }
    return false;
}

/// What the copy `old` of the last frame still knows about a dynamic body whose original is now in the state `b.state`.
void carryOver(const Body& old, double frame, const GapClosing& closing, double reach, Body& b) {
    const BodyState &now = b.state, &seen = old.hostCoupling.seen;
    HostCoupling& h = b.hostCoupling;
    h.unexplained = old.hostCoupling.unexplained.during(frame);
    h.all = old.hostCoupling.all.during(frame);
    const bool moved = now.centre != seen.centre || now.angle != seen.angle; // by its user
    if (now.velocity == seen.velocity && now.spin == seen.spin) {
        b.state.velocity = old.state.velocity;
        b.state.spin = old.state.spin;
    }
    if (!moved) {
        const Vec2 way = now.centre - old.state.centre;
        const double turn = now.angle - old.state.angle;
        if (way.norm() + std::abs(turn) * reach > hostRounding(old.state, reach)) { // a rounding is no way
            h.drift = (way - closing.left(way, frame)) / frame;
            if (reach > 0.0)
                h.driftSpin = (turn - closing.left(reach * turn, frame) / reach) / frame;
        }
        b.state.centre = old.state.centre;
        if (reach > 0.0) // nobody sees how another one is turned
            b.state.angle = old.state.angle;
    }
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

/// A body without mass that its user put somewhere else, no farther than its size, without giving it a velocity for
/// that: it goes there within `time` s, and pushes what is in its way. A longer way is a jump. Ways of a fiftieth of a
/// thickness are the host's rounding.
void followPlacement(const Body& old, double time, double thickness, double reach, Body& b) {
    const Vec2 way = b.state.centre - old.state.centre;
    const double turn = b.state.angle - old.state.angle;
    const double far = way.norm() + std::abs(turn) * reach;
    if (far <= 0.02 * thickness || isJump(old.state, b.state, thickness, reach))
        return;
    b.state.centre = old.state.centre;
    b.state.angle = old.state.angle;
    b.state.velocity += way / time;
    b.state.spin += turn / time;
}

/// Thickness of the thinnest shell that may come near a body in the coming frame, m; of all shells if none can.
double thicknessNear(const World& world, const Settings& settings, const std::vector<Box>& regions, const Body& b,
                     double reach, double frame) {
    if (settings.length > 0.0)
        return settings.length;
    const double way = reach + frame * b.state.velocity.norm();
    double thinnest = std::numeric_limits<double>::infinity();
    const auto take = [&](const Rod& r) { thinnest = std::min(thinnest, r.model.definition().thickness); };
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        if (((b.state.centre.array() + way) >= regions[i].lower.array()).all() &&
            ((b.state.centre.array() - way) <= regions[i].upper.array()).all())
            take(world.rods[i]);
    for (const Link& l : world.links)
        if (l.end == LinkEnd::Body && l.body == b.id)
            if (const int rod = rodIndex(world, l.rodA); rod >= 0)
                take(world.rods[static_cast<std::size_t>(rod)]);
    return std::isfinite(thinnest) ? thinnest : step::thinnest(world);
}

void unique(std::vector<BodyId>& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}

bool isIn(const std::vector<BodyId>& sorted, BodyId id) {
    return std::binary_search(sorted.begin(), sorted.end(), id);
}

/// The bodies `reading.ids` (sorted) with fresh states; driven ones keep our pose, known ones what was learnt about
/// them. Those with numbers that are not finite are refused.
void readBodies(const World& world, const Port& port, const Settings& settings, double frame, HostReading& reading) {
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
        const double reach = farthestPoint(world, reading.outlines, id);
        b.thicknessNear = thicknessNear(world, settings, reading.regions, b, reach, frame);
        if (const int index = bodyIndex(world, id); index >= 0) {
            const Body& old = world.bodies[static_cast<std::size_t>(index)];
            if (b.driven && old.driven)
                b.state = old.state;
            else if (!b.driven && !b.dynamic && !old.driven && !old.dynamic && !isIn(reading.jumped, id))
                followPlacement(old, std::max(frame, shortStep(settings)), b.thicknessNear, reach, b);
            if (!b.driven && !b.dynamic && !world.stopped.empty())
                standStill(world, old, b);
            b.force = old.force;
            b.woken = old.woken;
            b.stillTime = old.stillTime;
            b.stillCentre = old.stillCentre;
            b.stillAngle = old.stillAngle;
            if (old.asleep())
                sleepOn(old, frame, b);
            else if (b.dynamic && !refused && old.hostCoupling.known)
                carryOver(old, frame, {settings.recovery * b.thicknessNear}, reach, b);
        }
        SC_ASSERT(!b.dynamic || b.state.mass > 0.0, "a dynamic body has a mass");
        bodies.push_back(b);
    }
    SC_ASSERT(invariants::strictlyRising(bodies, [](const Body& b) { return b.id; }),
              "bodies are unique, sorted by id");
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

bool finite(const BodyState& s) {
    return s.centre.allFinite() && s.velocity.allFinite() && std::isfinite(s.angle) && std::isfinite(s.spin) &&
           std::isfinite(s.mass) && std::isfinite(s.inertia) && std::isfinite(s.gravityScale) &&
           std::isfinite(s.linearDamping) && std::isfinite(s.angularDamping);
}

bool isJump(const BodyState& from, const BodyState& to, double thickness, double reach) {
    const double far = (to.centre - from.centre).norm() + std::abs(to.angle - from.angle) * reach;
    return far > 0.02 * thickness && far > 2.0 * reach;
}

void readHost(World& world, const Port& port, const Settings& settings, double frame, bool nearOnly,
              HostReading& reading) {
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
    wakeChanged(world, port);
    carryAlong(world, port, reading);
    std::vector<BodyOutline>& outlines = reading.outlines;
    std::vector<BodyId>& ids = reading.ids;
    std::vector<Body>& bodies = reading.bodies;
    clearJoined(reading.joining, outlines);
    reading.regions.clear();
    for (const Rod& r : world.rods)
        reading.regions.push_back(reachOf(world, r, r.kin, r.speed, frame));
    const Box read = hull(reading.regions);
    if (!world.rods.empty()) // what a rod sees must not depend on rods far away, between which there is more to read
        port.queryAhead(nearOnly ? std::span<const Box>(reading.regions) : std::span<const Box>(&read, 1), frame,
                        outlines);
    ids.assign(world.crossheadBodies.begin(), world.crossheadBodies.end());
    for (const BodyOutline& o : outlines)
        ids.push_back(o.body);
    for (const Link& l : world.links)
        if (l.end == LinkEnd::Body)
            ids.push_back(l.body);
    for (const Body& b : world.bodies)
        if (b.asleep() || b.woken)
            ids.push_back(b.id);
    unique(ids);
    world.constraints.clear();
    port.constraints(ids, frame, world.constraints);
    for (const HostContact& c : world.constraints.contacts)
        ids.insert(ids.end(), {c.a, c.b});
    for (const HostRow& r : world.constraints.rows)
        ids.insert(ids.end(), {r.a, r.b});
    unique(ids);
    readBodies(world, port, settings, frame, reading);
    leaveOut(reading.refused, world.constraints);
    std::erase_if(outlines, [&](const BodyOutline& o) {
        return isIn(reading.refused, o.body) ||
               std::none_of(bodies.begin(), bodies.end(), [&](const Body& b) { return b.id == o.body; });
    });
    wakeTouched(world, bodies, outlines, reading.regions);
    joinOutlines(world, port, read, bodies, frame, reading.joining, outlines);
    wakeByHost(world, bodies, outlines, frame);
    if (!std::equal(outlines.begin(), outlines.end(), world.outlines.begin(), world.outlines.end(),
                    [](const BodyOutline& a, const BodyOutline& b) { return sameButSeams(a, b); }) ||
        !samePoses(bodies, world.bodies))
        world.range.clear();             // candidates refer to outlines by index and to poses
    std::swap(world.outlines, outlines); // the storage of the last frame serves the next one
    std::swap(world.bodies, bodies);
    wakeAsBefore(bodies, world.bodies);
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

bool leavesRegions(const World& world, const TrialStep& t, double left, HostReading& reading) {
    bool leaves = false;
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        const Rod& r = world.rods[i];
        const RodWork& w = t.rods[i];
        if (w.frozen || !outside(r, w.kin1, reading.regions[i]))
            continue;
        widen(reading.regions[i], reachOf(world, r, w.kin1, w.moved / t.dt, left));
        leaves = true;
    }
    return leaves;
}

bool readAgain(World& world, const Port& port, const Settings& settings, double frame, double elapsed,
               HostReading& reading) {
    reading.outlines.clear();
    const Box read = hull(reading.regions);
    port.queryAhead(std::span<const Box>(&read, 1), frame, reading.outlines);
    std::erase_if(reading.outlines, [&](const BodyOutline& o) {
        return std::binary_search(world.outlines.begin(), world.outlines.end(), o, before);
    });
    if (reading.outlines.empty())
        return false;
    reading.ids.clear();
    for (const BodyOutline& o : reading.outlines)
        if (bodyIndex(world, o.body) < 0)
            reading.ids.push_back(o.body);
    unique(reading.ids);
    readBodies(world, port, settings, frame, reading);
    for (Body& b : reading.bodies) { // where they have come to by now
        const Vec2 fall = b.dynamic ? Vec2(elapsed * b.state.gravityScale * world.gravity) : Vec2(Vec2::Zero());
        b.hostCoupling.travel = elapsed * (b.state.velocity + 0.5 * fall);
        b.hostCoupling.turn = elapsed * b.state.spin;
        b.state.centre += b.hostCoupling.travel;
        b.state.angle += b.hostCoupling.turn;
        b.state.velocity += fall;
        world.bodies.push_back(b);
    }
    std::sort(world.bodies.begin(), world.bodies.end(), [](const Body& a, const Body& b) { return a.id < b.id; });
    for (BodyOutline& o : reading.outlines)
        if (bodyIndex(world, o.body) >= 0)
            world.outlines.push_back(std::move(o));
    std::sort(world.outlines.begin(), world.outlines.end(), before);
    world.range.clear(); // candidates refer to outlines by index
    return true;
}

} // namespace supercircle::step
