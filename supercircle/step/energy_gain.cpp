#include "supercircle/step/energy_gain.h"

#include "supercircle/rod/elasticity.h"
#include "supercircle/rod/inertia.h"
#include "supercircle/step/contact_memory.h"
#include "supercircle/step/contacts/contact_rows.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

double movedEnergy(const EnergyBalance& before, const World& world) {
    const EnergyBalance& now = world.energyBalance;
    double kinetic = 0.0, bending = 0.0; // the balance of an island begins at zero: it has their changes only
    for (const Rod& r : world.rods)
        if (!r.frozen()) {
            kinetic += rod::kineticEnergy(r.gauss, r.u);
            bending += rod::bendingEnergy(r.model, r.q);
        }
    double moved = std::max({before.kinetic, now.kinetic, kinetic, kinetic - (now.kinetic - before.kinetic)}) +
                   std::max({before.bending, now.bending, bending, bending - (now.bending - before.bending)}) +
                   std::abs(now.work - before.work) + std::abs(now.toBodies - before.toBodies);
    for (const Body& b : world.bodies)
        if (b.dynamic)
            moved += 0.5 * b.state.mass * b.state.velocity.squaredNorm() +
                     0.5 * b.state.inertia * b.state.spin * b.state.spin;
    return moved;
}

double gainedEnergy(const EnergyBalance& before, const World& world) {
    const EnergyBalance& now = world.energyBalance;
    const auto taken = [](const EnergyBalance& b) {
        return b.friction + b.impact + b.numerical + b.positionCorrection + b.damping;
    };
    const double byEffects = std::max(0.0, now.effects - before.effects); // they may give what they stored
    return std::max(0.0, taken(before) - taken(now) - byEffects);
}

double boundOfGain(const EnergyBalance& before, const World& world, const Settings& settings, double dt) {
    double rows = 0.0;
    const OverlapClosing overlaps = overlapClosing(settings, 1.0);
    const double parting = overlaps.fastest(settings.fixedDt);                         // h/s
    const auto addRow = [&](const Rod& r, double speed, double force, double atOnce) { // h/s, N, h
        const double h = lengthOf(r, settings.length);
        rows += 0.5 * r.model.mass() * speed * speed * h * h + force * (settings.recovery * dt + atOnce) * h;
    };
    for (const Rod& r : world.rods) {
        if (r.frozen())
            continue;
        addRow(r, parting, 0.0, 0.0); // of contacts that have opened meanwhile
        if (r.model.definition().closed)
            addRow(r, settings.recovery, 0.0, 0.0);
        for (const Hold& h : r.holds)
            addRow(r, settings.recovery, h.reaction.norm(), 0.0);
    }
    for (const Link& l : world.links)
        if (const int i = rodIndex(world, l.rodA); i >= 0)
            addRow(world.rods[static_cast<std::size_t>(i)], settings.recovery, l.force.norm(), 0.0);
    for (const contact::Candidate& c : world.candidates) {
        const ContactImpulse* f = findImpulse(world.impulses, c.id);
        addRow(world.rods[static_cast<std::size_t>(c.a.rod)], parting, f ? f->normal : 0.0, overlaps.overlap);
    }
    for (const Body& b : world.bodies)
        if (b.dynamic) {
            const double speed = settings.recovery * b.thicknessNear;
            rows += 0.5 * b.state.mass * speed * speed;
        }
    const double moved = movedEnergy(before, world);
    const double byOverlaps = world.energyBalance.injected.contact - before.injected.contact;
    return kGainShare * moved + std::min(byOverlaps, kGainShareOfOverlaps * moved) + rows;
}

} // namespace supercircle::step
