// Stage Predict: A = M + dt^2 K = L L^T per rod, free velocity v_free = A^-1 (p + dt F).

#include "supercircle/step/parallel.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

namespace supercircle::step {

void predict(const World& world, TrialStep& t) {
    t.enter(Stage::Predict, Stage::Evaluate);
    forEachRod(t.stage.loop, world.rods.size(), [&](std::size_t i) {
        if (t.rods[i].solved())
            predictRod(world.rods[i], t.rods[i]);
    });
}

} // namespace supercircle::step
