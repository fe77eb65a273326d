// Stage Drive: velocities of what the crosshead carries, paths of held points.

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/contacts/gap_closing.h"
#include "supercircle/step/stages/stages.h"

#include <algorithm>

namespace supercircle::step {

void drive(World& world, const Settings& settings, double frame) {
    for (Body& b : world.bodies) {
        b.impulse.setZero();
        b.angularImpulse = 0.0;
        if (b.driven)
            b.state.velocity = world.crossheadVelocity;
    }
    startPaths(world, std::max(frame, shortStep(settings)));
}

} // namespace supercircle::step
