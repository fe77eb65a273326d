// Stage Evaluate: force F(q) and tangent -dF/dq of bending, loads, effects, and of contact forces that turn with the
// rods.

#include "supercircle/step/contacts/adhesion.h"
#include "supercircle/step/contacts/contact_stiffness.h"
#include "supercircle/step/parallel.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

namespace supercircle::step {

void evaluate(const World& world, TrialStep& t) {
    t.enter(Stage::Evaluate, Stage::Linearise);
    collectRolling(world, t.rods, t.dt, t.impulses, t.first(), t.stage);
    collectAxial(world, t.rods, t.impulses, t.stage);
    collectAdhesion(world, t.rods, t.dt, t.stage);
    forEachRod(t.stage.loop, world.rods.size(), [&](std::size_t i) {
        if (!t.rods[i].solved())
            return;
        evaluateRod(world, world.rods[i], t.dt, t.first(), t.rods[i]);
        addAdhesion(t.stage, static_cast<int>(i), t.dt, t.rods[i]);
    });
}

} // namespace supercircle::step
