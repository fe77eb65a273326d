// Stage Check: numbers that came in are finite.

#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <cmath>

namespace supercircle::step {

void quarantine(World& world, Rod& r, QuarantineReason reason) {
    r.quarantined = true;
    r.quarantineReason = reason;
    r.quarantinedAt = world.time;
    r.q = r.lastAccepted;
    r.v.setZero();
    const double kinetic = rod::kineticEnergy(r.gauss, r.u);
    if (std::isfinite(kinetic)) { // its motion leaves the energy balance as it leaves the world
        world.energyBalance.kinetic -= kinetic;
        world.energyBalance.added -= kinetic;
    }
    refreshRod(r);
    SC_ASSERT(r.v.isZero(0.0) && r.q.size() == r.model.dofs(), "a quarantined rod stands still");
    world.range.clear();
    ++world.counters.quarantined;
}

void checkNumbers(World& world, const Settings& settings) {
    for (Rod& r : world.rods) {
        if (!r.quarantined && !(r.q.allFinite() && r.v.allFinite()))
            quarantine(world, r, QuarantineReason::NotFinite);
        if (r.quarantined && world.time - r.quarantinedAt >= settings.recoverAfter) {
            r.quarantined = false; // at rest, in its last accepted place; what stands there by now overlaps it
            world.range.clear();
        }
    }
}

} // namespace supercircle::step
