// Stage Drive: velocities of what the crosshead carries, paths of held points.

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/stages/stages.h"

namespace supercircle::step {

void drive(World& world, double frame) {
    for (Body& b : world.bodies) {
        b.impulse.setZero();
        b.angularImpulse = 0.0;
        if (b.driven)
            b.state.velocity = world.crossheadVelocity;
    }
    startPaths(world, frame);
}

} // namespace supercircle::step
