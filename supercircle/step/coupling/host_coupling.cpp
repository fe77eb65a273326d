#include "supercircle/step/coupling/host_coupling.h"

#include "supercircle/step/coupling/stray_bodies.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

/// h, motion in a frame up to which a body rests, and up to which its original then goes back to the copy: roundings
/// and what the host's sweeps leave. Half of it and twice as much keep a stack of crates as well (it gains 4e-8 to
/// 1.4e-7 J in a minute, 5.5e-7 J without). The host lifts a fifth of an overlap in a frame, so bodies may stay five
/// times this deep in each other.
constexpr double kAtRest = 0.1 * kLeave;

/// Bodies among the suspects (indices into World::bodies) whose original stands deeper in a shell than its copy:
/// HostCouplingWork::intruding; or beyond it: HostCouplingWork::crossing.
void findIntruders(const World& world, HostCouplingWork& work) {
    takeCurves(world, work);
    const std::vector<contact::RodCurve>& curves = work.curves;
    std::vector<contact::Outline>&copies = work.copies, &originals = work.originals;
    std::vector<int>& owner = work.owner;
    std::size_t count = 0;
    owner.clear();
    for (const int i : work.suspects) {
        const Body& b = world.bodies[static_cast<std::size_t>(i)];
        for (const BodyOutline& o : world.outlines) {
            if (o.body != b.id)
                continue;
            if (count == copies.size()) {
                copies.emplace_back();
                originals.emplace_back();
            }
            place(o, b.state.centre, b.state.angle, copies[count]);
            place(o, b.hostCoupling.seen.centre, b.hostCoupling.seen.angle, originals[count]);
            copies[count].key = originals[count].key = static_cast<std::uint32_t>(count);
            owner.push_back(i);
            ++count;
        }
    }
    copies.resize(count);
    originals.resize(count);
    SC_ASSERT(owner.size() == count, "one owner an outline");
    depths(copies, work, work.depthOfCopy);
    depths(originals, work, work.depthOfOriginal);
    work.crossings.clear();
    contact::findCrossingsSwept(curves, curves, copies, originals, work.crossings);
    work.intruding.clear();
    work.crossing.clear();
    for (std::size_t k = 0; k < owner.size(); ++k) {
        const bool crosses = std::any_of(work.crossings.begin(), work.crossings.end(), [&](const contact::Crossing& c) {
            return c.rodB < 0 && c.outline == static_cast<int>(k);
        });
        const double h = world.bodies[static_cast<std::size_t>(owner[k])].thicknessNear;
        if (crosses)
            work.crossing.push_back(owner[k]);
        else if (work.depthOfOriginal[k] > work.depthOfCopy[k] + kLeave * h)
            work.intruding.push_back(owner[k]);
    }
}

/// Puts back a body that is past a shell: a copy that pressed on shells is right, another one goes on to the shell.
/// False: only past shells that let it pass.
bool putBackCrossing(const World& world, const PairFilter& filter, Port& port, HostCouplingWork& work, Body& b) {
    HostCoupling& h = b.hostCoupling;
    const double share = freeShare(world, outlinesOf(world.outlines, b.id), b.state, h.seen, filter, work);
    if (share >= 1.0)
        return false;
    if (!h.coupled)
        moveAlong(b.state, h.seen, share, b.state);
    port.putBack(b.id, b.state.centre, b.state.angle);
    seePutBack(port, b);
    return true;
}

/// Its constraints were in our problem all the frame long, so that our impulses can be compared with the host's.
bool solvedThroughout(const Body& b, double advanced) {
    return b.dynamic && b.hostCoupling.coupledTime > 0.999 * advanced;
}

} // namespace

double farthestPoint(const World& world, const std::vector<BodyOutline>& outlines, BodyId body) {
    double reach = 0.0;
    for (const BodyOutline& o : outlines)
        if (o.body == body)
            for (const Vec2& p : o.local.points)
                reach = std::max(reach, p.norm() + o.local.radius);
    for (const Link& l : world.links)
        if (l.end == LinkEnd::Body && l.body == body)
            reach = std::max(reach, l.local.norm());
    for (const HostContact& c : world.constraints.contacts) {
        if (c.a == body)
            reach = std::max(reach, c.armA.norm());
        if (c.b == body)
            reach = std::max(reach, c.armB.norm());
    }
    return reach;
}

double hostRounding(const BodyState& s, double reach) {
    return static_cast<double>(std::numeric_limits<float>::epsilon()) *
           (s.centre.cwiseAbs().maxCoeff() + std::abs(s.angle) * reach);
}

void unsolvedByHost(const World& world, const Port& port, double advanced, HostCouplingWork& work) {
    std::vector<BodyMotion>& out = work.unsolved;
    out.assign(world.bodies.size(), {});
    const auto add = [&](BodyId id, const Vec2& impulse, double turn) {
        const int i = bodyIndex(world, id);
        if (i < 0)
            return;
        const Body& b = world.bodies[static_cast<std::size_t>(i)];
        if (!solvedThroughout(b, advanced))
            return;
        SC_ASSERT(b.state.mass > 0.0, "a dynamic body has a mass");
        out[static_cast<std::size_t>(i)].velocity += impulse / b.state.mass;
        if (b.state.inertia > 0.0)
            out[static_cast<std::size_t>(i)].spin += turn / b.state.inertia;
    };
    std::vector<BodyId>& impulseUnknown = work.impulseUnknown;
    impulseUnknown.clear();
    for (const HostContact& c : world.constraints.contacts) {
        if (c.impulseUnknown)
            impulseUnknown.insert(impulseUnknown.end(), {c.a, c.b});
        if (!c.impulseKnown)
            continue;
        const Vec2 f = (c.hostNormal - c.sumNormal) * c.normal + (c.hostTangent - c.sumTangent) * rod::perp(c.normal);
        add(c.a, -f, -rod::cross(c.armA, f));
        add(c.b, f, rod::cross(c.armB, f));
    }
    for (const HostRow& r : world.constraints.rows) {
        if (!r.impulseKnown)
            continue;
        const double f = r.host - r.sum;
        add(r.a, f * r.axisA, f * r.turnA);
        add(r.b, f * r.axisB, f * r.turnB);
    }
    for (const int i : work.woken) { // it fell without the shells' support
        const BodyState& s = world.bodies[static_cast<std::size_t>(i)].state;
        out[static_cast<std::size_t>(i)].velocity += advanced * s.gravityScale * world.gravity;
    }
    const HostConstraints& c = world.constraints;
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        const Body& b = world.bodies[i];
        BodyState now;
        if (!solvedThroughout(b, advanced) || !port.state(b.id, now))
            continue;
        const bool capped =
            advanced * now.velocity.norm() > 0.99 * c.farthest || advanced * std::abs(now.spin) > 0.99 * c.mostTurn;
        const bool unknown = std::find(impulseUnknown.begin(), impulseUnknown.end(), b.id) != impulseUnknown.end();
        if (capped || unknown) // all of it counts as error
            out[i] = {now.velocity - b.hostCoupling.handed, now.spin - b.hostCoupling.handedSpin};
    }
}

void reconcilePoses(World& world, const PairFilter& filter, Port& port, double advanced, HostCouplingWork& work) {
    SC_ASSERT(work.unsolved.size() == world.bodies.size(), "one motion a body");
    const std::vector<BodyMotion>& unsolved = work.unsolved;
    std::vector<int>& suspects = work.suspects;
    suspects.clear();
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        Body& b = world.bodies[i];
        if (!b.hostCoupling.known || b.asleep())
            continue;
        const double h = b.thicknessNear;
        const Vec2 astray = advanced * unsolved[i].velocity;
        const double turned = advanced * unsolved[i].spin;
        if (astray.norm() + std::abs(turned) * farthestPoint(world, world.outlines, b.id) > kAtRest * h) {
            port.place(b.id, b.hostCoupling.seen.centre - astray, b.hostCoupling.seen.angle - turned);
            (void)port.state(b.id, b.hostCoupling.seen); // it answered in this frame
        }
        const BodyState& seen = b.hostCoupling.seen;
        const double reach = farthestPoint(world, world.outlines, b.id);
        const double off = (seen.centre - b.state.centre).norm() + std::abs(seen.angle - b.state.angle) * reach;
        const double way = b.hostCoupling.travel.norm() + std::abs(b.hostCoupling.turn) * reach;
        if (off > hostRounding(b.state, reach) && off <= kAtRest * h && way <= kAtRest * h) {
            port.place(b.id, b.state.centre, b.state.angle);
            (void)port.state(b.id, b.hostCoupling.seen); // it answered in this frame
        }
        if (off > kLeave * h)
            suspects.push_back(static_cast<int>(i));
    }
    if (suspects.empty())
        return;
    findIntruders(world, work);
    const auto isIn = [](const std::vector<int>& list, int i) {
        return std::find(list.begin(), list.end(), i) != list.end();
    };
    for (const int i : suspects) {
        Body& b = world.bodies[static_cast<std::size_t>(i)];
        if (isIn(work.crossing, i) && putBackCrossing(world, filter, port, work, b))
            continue;
        if (isIn(work.crossing, i) || isIn(work.intruding, i)) {
            port.place(b.id, b.state.centre, b.state.angle);
            (void)port.state(b.id, b.hostCoupling.seen); // it answered in this frame
        } else {
            b.state.centre = b.hostCoupling.seen.centre;
            b.state.angle = b.hostCoupling.seen.angle;
        }
    }
}

} // namespace supercircle::step
