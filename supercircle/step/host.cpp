// The shells' side of the host: what is pulled before a frame, handed over after it, and learnt from the host's step.

#include "supercircle/step/stepper.h"

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

bool sameOutlines(const std::vector<BodyOutline>& a, const std::vector<BodyOutline>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) {
               return x.body == y.body && x.local.key == y.local.key && x.friction == y.friction &&
                      x.local.points == y.local.points;
           });
}

/// The bodies of `outlines` with fresh states; driven ones keep our pose, known ones what was learnt about them.
std::vector<Body> readBodies(const World& world, const Port& port, const std::vector<BodyOutline>& outlines) {
    std::vector<BodyId> ids = world.machineBodies;
    for (const BodyOutline& o : outlines)
        ids.push_back(o.body);
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    std::vector<Body> bodies;
    for (const BodyId id : ids) {
        Body b;
        b.id = id;
        if (!port.state(id, b.state))
            continue;
        b.driven = std::find(world.machineBodies.begin(), world.machineBodies.end(), id) != world.machineBodies.end();
        b.dynamic = b.state.mass > 0.0 && b.state.enabled && !b.driven;
        const auto old = std::lower_bound(world.bodies.begin(), world.bodies.end(), id,
                                          [](const Body& x, BodyId want) { return x.id < want; });
        if (old != world.bodies.end() && old->id == id) {
            if (b.driven && old->driven)
                b.state = old->state;
            b.feedForward = old->feedForward;
            b.feedForwardSpin = old->feedForwardSpin;
            b.force = old->force;
        }
        bodies.push_back(b);
    }
    return bodies;
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
    }
    std::vector<BodyOutline> outlines;
    if (!world.rods.empty())
        port.query(reach(world, frame), outlines);
    std::vector<Body> bodies = readBodies(world, port, outlines);
    std::erase_if(outlines, [&](const BodyOutline& o) {
        return std::none_of(bodies.begin(), bodies.end(), [&](const Body& b) { return b.id == o.body; });
    });
    if (!sameOutlines(outlines, world.outlines) || !samePoses(bodies, world.bodies))
        world.range.clear(); // candidates refer to outlines by index and to poses
    world.outlines = std::move(outlines);
    world.bodies = std::move(bodies);
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
        if (!b.impulse.isZero(0.0) || b.angularImpulse != 0.0)
            port.applyImpulse(b.id, b.impulse, b.angularImpulse);
        const double slow = 1.0 / (1.0 + advanced * now.linearDamping);
        b.expected = (now.velocity + b.impulse / now.mass + advanced * now.gravityScale * world.gravity) * slow;
        b.expectedSpin = (now.spin + (now.inertia > 0.0 ? b.angularImpulse / now.inertia : 0.0)) /
                         (1.0 + advanced * now.angularDamping);
    }
}

void Stepper::learnFromHost(World& world, const Port& port, double advanced) {
    for (Body& b : world.bodies) {
        BodyState now;
        if (!b.dynamic || !(advanced > 0.0) || !port.state(b.id, now))
            continue;
        b.feedForward = (now.velocity - b.expected) / advanced;
        b.feedForwardSpin = (now.spin - b.expectedSpin) / advanced;
    }
}

} // namespace supercircle::step
