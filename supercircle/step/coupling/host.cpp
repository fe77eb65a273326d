// The shells' side of the host: what is pulled before a frame, handed over after it, and learnt from the host's step.

#include "supercircle/step/coupling/handover.h"
#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/stepper_work.h"

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
void takeUp(const Body& old, double frame, Body& b) {
    const BodyState &now = b.state, &seen = old.handover.seen;
    Handover& h = b.handover;
    h.unexplained = old.handover.unexplained;
    h.all = old.handover.all;
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
        b.driven = std::find(world.machineBodies.begin(), world.machineBodies.end(), id) != world.machineBodies.end();
        b.dynamic = b.state.mass > 0.0 && b.state.enabled && !b.driven;
        if (const int index = bodyIndex(world, id); index >= 0) {
            const Body& old = world.bodies[static_cast<std::size_t>(index)];
            if (b.driven && old.driven)
                b.state = old.state;
            b.force = old.force;
            if (b.dynamic && old.handover.known)
                takeUp(old, frame, b);
        }
        bodies.push_back(b);
    }
}

bool samePoses(const std::vector<Body>& a, const std::vector<Body>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Body& x, const Body& y) {
               return x.id == y.id && x.state.centre == y.state.centre && x.state.angle == y.state.angle &&
                      x.state.velocity == y.state.velocity && x.state.spin == y.state.spin;
           });
}

} // namespace

void Stepper::pullFromHost(World& world, const Port& port, double frame) const {
    const Vec2 g = port.gravity();
    if (g != world.gravity) { // the potential of the shells is measured anew; that is no work of anybody
        double change = 0.0;
        for (const Rod& r : world.rods)
            change -= r.model.mass() * (g - world.gravity).dot(rod::massCentre(r.kin, r.gauss));
        world.ledger.gravity += change;
        world.ledger.added += change;
        world.gravity = g;
        wakeAll(world);
    }
    std::vector<BodyOutline>& outlines = work_->pull.outlines;
    std::vector<BodyId>& ids = work_->pull.ids;
    std::vector<Body>& bodies = work_->pull.bodies;
    outlines.clear();
    if (!world.rods.empty())
        port.query(reach(world, frame), outlines);
    ids.assign(world.machineBodies.begin(), world.machineBodies.end());
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
}

void Stepper::pushToHost(World& world, Port& port, double advanced) {
    for (Body& b : world.bodies) {
        if (b.driven) {
            port.drive(b.id, b.state.centre - advanced * b.state.velocity, b.state.angle - advanced * b.state.spin,
                       b.state.velocity, b.state.spin);
            continue;
        }
        if (!b.dynamic)
            continue;
        BodyState now;
        if (!port.state(b.id, now))
            continue;
        const double slow = 1.0 + advanced * now.linearDamping, slowSpin = 1.0 + advanced * now.angularDamping;
        const Vec2 fall = advanced * now.gravityScale * world.gravity;
        Handover& h = b.handover;
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

void Stepper::learnFromHost(World& world, Port& port, double advanced) const {
    if (!(advanced > 0.0))
        return;
    port.impulses(advanced, world.constraints);
    unsolvedByHost(world, port, advanced, work_->handover);
    const std::vector<BodyMotion>& unsolved = work_->handover.unsolved;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        Body& b = world.bodies[i];
        Handover& h = b.handover;
        BodyState now;
        h.known = b.dynamic && port.state(b.id, now);
        if (!h.known)
            continue;
        const Vec2 change = now.velocity - h.handed - unsolved[i].velocity;
        const double turn = now.spin - h.handedSpin - unsolved[i].spin;
        const BodyState& s = b.state;
        const Vec2 expected = h.hostImpulse / s.mass;
        const double expectedTurn = s.inertia > 0.0 ? h.hostTurnImpulse / s.inertia : 0.0;
        h.all.learn((expected + change) / advanced, (expectedTurn + turn) / advanced);
        h.unexplained.learn(h.coupled ? Vec2(change / advanced + h.unexplained.expectedLinear) : Vec2(Vec2::Zero()),
                            h.coupled ? turn / advanced + h.unexplained.expectedAngular : 0.0);
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
    settlePlaces(world, port, advanced, work_->handover);
    world.constraints.clear(); // names the host's addresses: nothing to keep between frames
}

} // namespace supercircle::step
