// Stage Check: numbers that came in are finite.

#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <cmath>

namespace supercircle::step {

void quarantine(World& world, Rod& r) {
    r.quarantined = true;
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

void checkNumbers(World& world) {
    for (Rod& r : world.rods)
        if (!r.quarantined && !(r.q.allFinite() && r.v.allFinite()))
            quarantine(world, r);
}

} // namespace supercircle::step
