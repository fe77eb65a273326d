#include "supercircle/step/stages/trial_step.h"

#include "supercircle/step/parallel.h"
#include "supercircle/step/stages/stages.h"

#include <limits>

namespace supercircle::step {

void TrialStep::begin(const World& world, const Settings& settings) {
    result.reason = Reason::None;
    result.judged = false;
    result.solves = result.contactsSolved = result.gaussSeidelIterations = result.pivots = 0;
    result.sleepers.clear();
    result.runaways.clear();
    result.crossings.clear();
    linearisations = widenings = 0;
    SC_ASSERT(dt > 0.0 && h > 0.0, "a step takes time, a shell is thick");
    SC_ASSERT(result.range.size() == world.rods.size(), "one range a rod");
    rods.resize(world.rods.size());
    impulses = world.impulses;
    overlapAtStart = deepest(candidates(world));
    stage.overlap = 2.0 * settings.rejectPenetration * h;
    stage.closes = settings.fixedDt <= 0.0 ? settings.localError * h : std::numeric_limits<double>::infinity();
    stage.recovery = settings.recovery * h;
    for (std::size_t i = 0; i < rods.size(); ++i)
        rods[i].closing.speed =
            settings.recovery * (settings.length > 0.0 ? settings.length : world.rods[i].model.definition().thickness);
}

void TrialStep::useThreads(int count, const parallel::For& hostLoop) {
    if (hostLoop)
        stage.loop = hostLoop;
    else if (count != threads)
        stage.loop = threadLoop(count);
    threads = hostLoop ? 0 : count;
}

} // namespace supercircle::step
