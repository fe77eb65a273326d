// Stage Accept: the trial becomes the state of rods and bodies; energies are recorded (energy_balance.h).

#include "supercircle/step/contact_memory.h"
#include "supercircle/step/contacts/adhesion.h"
#include "supercircle/step/contacts/friction_state.h"
#include "supercircle/step/contacts/link_rows.h"
#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/coupling/host_rows.h"
#include "supercircle/step/coupling/sleeping_bodies.h"
#include "supercircle/step/parallel.h"
#include "supercircle/step/rods/free_motion.h"
#include "supercircle/step/rods/rod_system.h"
#include "supercircle/step/stages/fingerprint.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

using Rows = Eigen::Matrix<double, 2, Eigen::Dynamic>;

void addImpulse(const Rows& J, const Vec2& r, double sign, RodWork& w) {
    w.product.noalias() = J.transpose() * r;
    w.contactImpulse += sign * w.product;
}

/// What the step changed of a contact point's velocity.
Vec2 change(const Rows& J, const Rod& rod, RodWork& w) {
    w.difference = w.v - rod.v;
    return J * w.difference;
}

/// Contact terms of the energy balance and the forces on bodies; uses the rods' old velocities, so before acceptRods.
void recordContacts(World& world, std::vector<RodWork>& rods, ContactStage& stage, double dt) {
    for (Body& b : world.bodies)
        b.force.setZero();
    for (std::size_t i = 0; i < rods.size(); ++i) {
        rods[i].impactShare = 0.0;
        rods[i].contactImpulse.setZero(world.rods[i].model.dofs());
    }
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const Vec2 r = stage.r.segment<2>(static_cast<Eigen::Index>(2 * i));
        if (r.isZero(0.0))
            continue;
        const contact::Candidate& c = stage.candidates[i];
        const ContactWork& k = stage.work[i];
        SC_ASSERT(invariants::inRange(k.rodA, rods.size()), "side A is a rod");
        SC_ASSERT(k.rodB >= 0 ? invariants::inRange(k.rodB, rods.size())
                              : invariants::inRange(k.bodyB, world.bodies.size()),
                  "side B is a rod or a body");
        RodWork& a = rods[static_cast<std::size_t>(k.rodA)];
        Vec2 u = k.Ja * a.v - k.surface;
        addImpulse(k.Ja, r, 1.0, a);
        a.impactShare += 0.5 * r.dot(change(k.Ja, world.rods[static_cast<std::size_t>(k.rodA)], a));
        const Vec2 force = (c.normal * r.x() + rod::perp(c.normal) * r.y()) / dt;
        if (k.rodB >= 0) {
            RodWork& b = rods[static_cast<std::size_t>(k.rodB)];
            u -= k.Jb * b.v;
            addImpulse(k.Jb, r, -1.0, b);
            b.impactShare -= 0.5 * r.dot(change(k.Jb, world.rods[static_cast<std::size_t>(k.rodB)], b));
        } else {
            Body& body = world.bodies[static_cast<std::size_t>(k.bodyB)];
            body.force -= force;
            const int index = stage.host.place[static_cast<std::size_t>(k.bodyB)].block;
            if (index >= 0) {
                const Vec2 ub = stage.problem.contacts[i].Hb * stage.velocity[static_cast<std::size_t>(index)];
                u += ub;
                world.energyBalance.toBodies += r.dot(ub);
                world.energyBalance.addDrift(r.dot(k.surface));
                const double turn = rod::cross(k.armB, force * dt);
                body.impulse -= force * dt;
                body.angularImpulse -= turn;
                body.hostCoupling.hostImpulse += force * dt; // what is not the shells' is the host's, see advanceBodies
                body.hostCoupling.hostTurnImpulse += turn;
            } else {
                world.energyBalance.work += r.dot(k.surface);
            }
        }
        if (!k.give.isZero(0.0)) { // the springs take their part
            const ContactImpulse* before = findImpulse(world.impulses, c.id);
            const Vec2 sprung(k.give.x() * (r.x() / dt - (before != nullptr ? before->normal : 0.0)),
                              k.give.y() * r.y() / dt - k.tangentialDeflection);
            world.energyBalance.numerical += r.dot(sprung) / dt; // what stays in them is taken off in accept
            u += sprung / dt;
        }
        world.energyBalance.friction -= r.y() * u.y();
        world.energyBalance.positionCorrection -= r.x() * u.x();
        world.energyBalance.injected.contact += std::max(0.0, r.x() * u.x());
    }
}

/// Far below what overflows when it is squared.
bool isModerate(const RodWork& w) {
    return w.v.squaredNorm() < 1e100 && w.q1.squaredNorm() < 1e100 && w.error < 1e50;
}

/// The energies of the motion itself. Forces, effects and gravity are given by others, in any size.
bool isFinite(const RodEnergies& e) {
    return std::isfinite(e.kineticChange + e.kineticLoss + e.bendingChange);
}

/// Energy in the springs of compliant contacts, J.
struct ComplianceEnergy {
    double compliance = 0.0, presliding = 0.0;
};
ComplianceEnergy complianceEnergy(const World& world, const std::vector<contact::Candidate>& candidates,
                                  const std::vector<ContactImpulse>& forces) {
    ComplianceEnergy sum;
    if (std::none_of(world.rods.begin(), world.rods.end(),
                     [](const Rod& r) { return r.effects.surface.model.compliant(); }))
        return sum;
    for (const contact::Candidate& c : candidates)
        if (const ContactImpulse* f = findImpulse(forces, c.id)) {
            const Vec2 give = complianceOf(world, c);
            const double constant = give.y() * f->tangent; // m, of the deflection
            sum.compliance += 0.5 * (give.x() * f->normal * f->normal + constant * f->tangent);
            sum.presliding += std::max(0.0, 0.5 * (f->tangentialDeflection - constant) * f->tangent);
        }
    return sum;
}

void advanceBodies(World& world, const ContactStage& stage, double dt) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        Body& b = world.bodies[i];
        const BodyMotion& m = stage.host.motion[i];
        b.state.centre += dt * m.velocity;
        b.state.angle += dt * m.spin;
        if (b.asleep())
            keepHostImpulse(b, dt);
        if (!b.dynamic || m.isFree)
            continue;
        HostCoupling& h = b.hostCoupling;
        const BodyMotion free = freeMotion(world, b, Vec2::Zero(), 0.0, dt);
        b.state.velocity = m.velocity - h.drift;
        b.state.spin = m.spin - h.driftSpin;
        h.hostImpulse += b.state.mass * (b.state.velocity - free.velocity);
        h.hostTurnImpulse += b.state.inertia * (b.state.spin - free.spin);
        h.travel += dt * b.state.velocity;
        h.turn += dt * b.state.spin;
        if (!stage.problem.contacts.empty() && stage.host.place[i].block >= 0) {
            h.coupled = true;
            h.coupledTime += dt;
        }
    }
    world.crossheadTravel += dt * world.crossheadVelocity;
}

/// All that the world keeps of a step fits its rods and bodies.
void assertConsistent(const World& world) {
    SC_ASSERT(world.range.size() == world.rods.size(), "one range a rod");
    SC_ASSERT_EXPENSIVE(invariants::strictlyRising(world.bodies, [](const Body& b) { return b.id; }),
                        "bodies are unique, sorted by id");
    for (const Rod& r : world.rods) {
        const Eigen::Index n = r.model.dofs();
        SC_ASSERT(r.q.size() == n && r.v.size() == n && r.lastAccepted.size() == n, "state sizes are the rod's");
        SC_ASSERT(r.u.size() == r.gauss.mass.size(), "one velocity a Gauss point");
        SC_ASSERT(r.frozen() || !(r.speed < 0.0), "a speed is not negative");
    }
    for (const contact::Candidate& c : world.candidates)
        SC_ASSERT_EXPENSIVE(invariants::inRange(c.a.rod, world.rods.size()) &&
                                (c.b.rod >= 0 ? invariants::inRange(c.b.rod, world.rods.size())
                                              : invariants::inRange(c.outline, world.outlines.size())),
                            "a candidate names rods and outlines of the world");
}

} // namespace

void accept(World& world, TrialStep& t) {
    SC_ASSERT(t.result.judged, "only a trial that came to its end is accepted");
    SC_ASSERT(t.reached == Stage::Linearise || t.reached == Stage::CheckCrossings, "accepted after its last stage");
    t.reached = Stage::Accept;
    const std::uint64_t sleepers = invariants::kExpensive ? fingerprintOfFrozen(world) : 0;
    std::vector<RodWork>& rods = t.rods;
    ContactStage& stage = t.stage;
    const double dt = t.dt;
    recordContacts(world, rods, stage, dt);
    recordLinks(world, rods, stage, dt);
    recordOverlaps(world, rods, stage, dt);
    EnergyBalance& l = world.energyBalance;
    const AdhesionEnergies pulls = recordAdhesion(world, rods, dt, stage);
    l.effects += pulls.taken;
    l.numerical += pulls.secondOrder;
    l.work += pulls.work;
    l.toBodies += pulls.toBodies;
    const auto hold = [&](effects::Key key, double held) {
        effects::EffectEnergy& give = world.effectsGone[static_cast<std::size_t>(key)];
        if (held != give.stored) {
            l.effects += held - give.stored;
            l.numerical -= held - give.stored;
            give.stored = held;
        }
    };
    const ComplianceEnergy held = complianceEnergy(world, stage.after, t.impulses);
    hold(effects::Key::ContactCompliance, held.compliance);
    hold(effects::Key::StaticFrictionExcess, held.presliding);
    advanceSurfaces(world, rods, dt, stage);
    std::vector<RodEnergies>& energies = t.energies;
    energies.assign(rods.size(), RodEnergies{});
    forEachRod(stage.loop, rods.size(), [&](std::size_t i) {
        if (!world.rods[i].frozen() && !(t.aside && rods[i].isFree))
            energies[i] = rods[i].isFree ? acceptFreeMotion(world, world.rods[i], dt, rods[i])
                                         : acceptRod(world, world.rods[i], dt, rods[i]);
    });
    for (std::size_t i = 0; i < rods.size(); ++i) {
        if (world.rods[i].frozen())
            continue;
        const RodEnergies& b = energies[i];
        const double impact = std::clamp(rods[i].impactShare, 0.0, b.kineticLoss);
        SC_ASSERT(!(b.kineticLoss < 0.0), "a sum of squares is not negative");
        SC_ASSERT(!(impact < 0.0) && !(impact > b.kineticLoss), "an impact takes a part of the loss");
        SC_ASSERT(isFinite(b) || !isModerate(rods[i]), "the energies of a moderate motion are finite");
        l.kinetic += b.kineticChange;
        l.bending += b.bendingChange;
        l.gravity += b.gravityChange;
        l.impact += impact;
        l.numerical += b.kineticLoss - impact + b.secondOrder;
        l.work += b.holdWork + b.loadWork;
        l.positionCorrection -= b.rollingWork;
        l.injected.hold += b.holdInjected;
        l.injected.rolling += std::max(0.0, b.rollingWork);
        l.effects += b.effects;
        l.damping += b.damping;
    }
    acceptHostConstraints(world, stage, dt);
    advanceBodies(world, stage, dt);
    for (std::size_t k = 0; k < t.groupCount && !t.aside; ++k)
        if (t.isFree(t.groups[k]))
            acceptFreeJoints(world, dt, t.groups[k]);
    advanceLinks(world, dt);
    world.impulses = t.impulses;
    world.candidates = stage.after;
    world.range = t.nextRange;
    world.dt = dt;
    ++world.counters.steps;
    world.counters.contactResidualMax = std::max(world.counters.contactResidualMax, stage.report.contactResidual);
    world.counters.contactsMax = std::max<std::uint64_t>(world.counters.contactsMax, stage.candidates.size());
    world.counters.activeContactsMax = std::max<std::uint64_t>(world.counters.activeContactsMax, t.impulses.size());
    if (!stage.report.converged)
        ++world.counters.unconverged;
    if (stage.report.byAbsoluteFloor)
        ++world.counters.byAbsoluteFloor;
    world.counters.penetrationMax = std::max(world.counters.penetrationMax, deepest(world.candidates));
    assertConsistent(world);
    SC_ASSERT_EXPENSIVE(sleepers == fingerprintOfFrozen(world), "a step leaves frozen rods as they are");
    (void)sleepers;
}

} // namespace supercircle::step
