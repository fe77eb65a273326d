// Stage Assemble: one Coulomb problem of contacts, joints and bodies of the host, with its warm start.

#include "supercircle/step/contacts/friction_state.h"
#include "supercircle/step/stages/stages.h"

namespace supercircle::step {

void assemble(const World& world, TrialStep& t) {
    couple(world, t.rods, t.dt, t.impulses, !t.first(), t.stage);
    applyFrictionState(world, t.rods, t.dt, !t.first(), t.stage);
}

} // namespace supercircle::step
