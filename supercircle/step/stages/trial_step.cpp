#include "supercircle/step/stages/trial_step.h"

#include "supercircle/step/parallel.h"
#include "supercircle/step/stages/stages.h"

#include <algorithm>

namespace supercircle::step {

void TrialStep::begin(const World& world, const Settings& settings) {
    result.reason = Reason::None;
    result.judged = result.outOfWork = false;
    result.work = {};
    result.solves = result.gaussSeidelIterations = result.pivots = 0;
    result.sleepers.clear();
    result.runaways.clear();
    result.crossings.clear();
    result.overlaps.clear();
    linearisations = widenings = 0;
    impulseScale = step::impulseScale(world);
    SC_ASSERT(dt > 0.0 && h > 0.0, "a step takes time, a shell is thick");
    SC_ASSERT(result.range.size() == world.rods.size(), "one range a rod");
    rods.resize(world.rods.size());
    impulses = world.impulses;
    lengths.clear();
    for (const Rod& r : world.rods)
        lengths.push_back(lengthOf(r, settings.length));
    overlapAtStart = 0.0;
    for (const contact::Candidate& c : candidates(world)) {
        const double length = lengthOf(world, settings.length, c);
        overlapAtStart = std::max(overlapAtStart, -c.gap * relative(length));
        for (const std::int32_t rod : {c.a.rod, c.b.rod})
            if (rod >= 0)
                lengths[static_cast<std::size_t>(rod)] = std::min(lengths[static_cast<std::size_t>(rod)], length);
    }
    stage.h = h;
    stage.length = settings.length;
    stage.overlaps = overlapClosing(settings, h);
    for (std::size_t i = 0; i < rods.size(); ++i)
        rods[i].closing.speed = settings.recovery * lengthOf(world.rods[i], settings.length);
}

void TrialStep::useThreads(int count, const parallel::For& hostLoop) {
    if (hostLoop)
        stage.loop = hostLoop;
    else if (count != threads)
        stage.loop = threadLoop(count);
    threads = hostLoop ? 0 : count;
}

} // namespace supercircle::step
