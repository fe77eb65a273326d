#include "supercircle/step/stages/fingerprint.h"

#include <bit>

namespace supercircle::step {

namespace {

/// FNV-1a on words of 64 bits.
class Hash {
public:
    void word(std::uint64_t bits) { value_ = (value_ ^ bits) * 0x100000001b3U; }
    void number(double x) { word(std::bit_cast<std::uint64_t>(x)); }
    void point(const Vec2& p) {
        number(p.x());
        number(p.y());
    }
    void vector(const Eigen::VectorXd& v) {
        word(static_cast<std::uint64_t>(v.size()));
        for (const double x : v)
            number(x);
    }
    void contacts(const std::vector<ContactImpulse>& list) {
        word(list.size());
        for (const ContactImpulse& c : list) {
            word(c.id);
            number(c.normal);
            number(c.tangent);
            number(c.tangentialDeflection);
        }
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325U;
};

void addMotion(const Rod& r, Hash& h) {
    h.vector(r.q);
    h.vector(r.v);
    h.vector(r.lastAccepted);
    for (const Vec2& u : r.u)
        h.point(u);
    h.number(r.speed);
    h.number(r.freeStep);
    h.number(r.vibration);
    h.word(r.island);
    h.word(r.quarantined ? 1 : 0);
}

void addRod(const Rod& r, Hash& h) {
    addMotion(r, h);
    h.word(r.key);
    h.number(r.stillTime);
    for (const Vec2& p : r.stillReference)
        h.point(p);
    for (const Hold& hold : r.holds) {
        h.point(hold.target.point);
        h.number(hold.target.angle);
        h.point(hold.reaction);
        h.number(hold.reactionTorque);
    }
    for (const AppliedForce& f : r.forces)
        h.point(f.force);
    for (const MouseJoint& m : r.mouseJoints)
        h.point(m.force);
    h.word(r.passing.size());
    for (const effects::EffectEnergy& e : r.effects.energies) {
        h.number(e.stored);
        h.number(e.dissipated);
    }
}

void addBody(const Body& b, Hash& h) {
    h.word(b.id);
    h.point(b.state.centre);
    h.number(b.state.angle);
    h.point(b.state.velocity);
    h.number(b.state.spin);
    h.point(b.impulse);
    h.number(b.angularImpulse);
    h.point(b.force);
    h.number(b.hostCoupling.coupledTime);
    h.point(b.hostCoupling.travel);
    h.point(b.hostCoupling.hostImpulse);
    h.word(b.island);
    h.word(b.dynamic ? 1 : 0);
}

void addEnergies(const EnergyBalance& e, Hash& h) {
    for (const double x : {e.kinetic, e.bending, e.gravity, e.added, e.work, e.friction, e.impact, e.numerical,
                           e.positionCorrection, e.effects, e.damping, e.toBodies})
        h.number(x);
}

} // namespace

std::uint64_t fingerprint(const World& world) {
    Hash h;
    h.number(world.time);
    h.point(world.gravity);
    for (const Rod& r : world.rods)
        addRod(r, h);
    for (const Body& b : world.bodies)
        addBody(b, h);
    for (const Link& l : world.links) {
        h.point(l.force);
        h.number(l.torque);
        h.number(l.length);
    }
    for (const HostContact& c : world.constraints.contacts) {
        h.number(c.clearance);
        h.number(c.sumNormal);
        h.number(c.sumTangent);
    }
    for (const HostRow& r : world.constraints.rows) {
        h.number(r.clearance);
        h.number(r.sum);
        h.word(static_cast<std::uint64_t>(r.saturated));
    }
    h.contacts(world.impulses);
    h.contacts(world.sleepingImpulses);
    h.point(world.crossheadTravel);
    addEnergies(world.energyBalance, h);
    h.word(world.candidates.size());
    for (const double range : world.range)
        h.number(range);
    h.number(world.dt);
    h.number(world.dtNext);
    h.word(world.counters.steps);
    h.word(world.counters.rejected);
    return h.value();
}

std::uint64_t fingerprintOfFrozen(const World& world) {
    Hash h;
    for (const Rod& r : world.rods)
        if (r.frozen())
            addMotion(r, h);
    return h.value();
}

} // namespace supercircle::step
