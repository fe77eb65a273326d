// Stage CheckCrossings: no centre line crosses another one or enters a solid on its way from start to end.

#include "supercircle/step/contacts/link_rows.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

namespace supercircle::step {

void checkCrossings(const World& world, TrialStep& t) {
    t.enter(Stage::CheckCrossings, Stage::Linearise);
    ContactStage& stage = t.stage;
    std::vector<contact::Crossing>& crossings = t.result.crossings;
    placeOutlines(world, stage.motion, 0.0, 0.0, stage.outlineKeys, t.outlinesBefore);
    t.curvesBefore.resize(world.rods.size());
    parallel::forEach(stage.loop, world.rods.size(), 32,
                      [&](std::size_t i) { toCurve(world.rods[i], world.rods[i].kin, t.curvesBefore[i]); });
    SC_ASSERT(t.curvesBefore.size() == stage.curves.size() && t.outlinesBefore.size() == stage.outlines.size(),
              "the same rods and outlines before and after");
    contact::CheckEffort effort{.maxWork = t.checkWorkLeft(), .bounded = true};
    contact::findCrossingsSwept(t.curvesBefore, stage.curves, t.outlinesBefore, stage.outlines, crossings, stage.loop,
                                &effort);
    if (effort.unfinished()) { // counted alike for any number of threads
        t.result.work.check.samples += effort.maxWork;
        t.result.outOfWork = true;
        return;
    }
    t.result.work.check.add(effort);
    const auto out = [&](std::int32_t rod) {
        return rod >= 0 && world.rods[static_cast<std::size_t>(rod)].quarantined;
    };
    const auto permitted = [&](const contact::Crossing& c) {
        return out(c.rodA) || out(c.rodB) || excluded(world, stage, c.rodA, c.rodB, c.outline);
    };
    std::erase_if(crossings, permitted);
    std::erase_if(effort.unjudged, permitted);
    if (!crossings.empty() || !effort.unjudged.empty())
        t.result.reason = Reason::Crossing;
}

} // namespace supercircle::step
