// Stage Detect: pairs whose gap g(q) may close within the step.

#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::step {

double deepest(const std::vector<contact::Candidate>& list) {
    double depth = 0.0;
    for (const contact::Candidate& c : list)
        depth = std::max(depth, -c.gap);
    return depth;
}

void detectAtStart(const World& world, const Settings& settings, TrialStep& t) {
    SC_ASSERT(t.dt > 0.0, "a step takes time");
    t.reached = Stage::Detect;
    TrialResult& r = t.result;
    r.renewed = false;
    r.range = world.range;
    bool known = r.range.size() == world.rods.size();
    for (std::size_t i = 0; known && i < world.rods.size(); ++i)
        known = r.range[i] >= 0.9 * world.rods[i].speed * t.dt;
    if (known)
        return;
    const double fall = world.gravity.norm() * t.dt * t.dt;
    r.range.resize(world.rods.size());
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        r.range[i] = 1.5 * world.rods[i].speed * t.dt + 2.0 * fall;
    detectWider(world, settings, t);
}

void detectWider(const World& world, const Settings& settings, TrialStep& t) {
    SC_ASSERT(t.reached == Stage::Detect || t.reached == Stage::Integrate, "at the start, or after a motion too far");
    t.reached = Stage::Detect;
    SC_ASSERT(t.result.range.size() == world.rods.size(), "one range a rod");
    t.kin.resize(world.rods.size());
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        t.kin[i] = &world.rods[i].kin;
    predictMotion(world, t.stage);
    collide(world, t.kin, t.result.range, 0.0, 2.0 * t.dt, settings.margin * t.h, t.stage, t.result.candidates);
    t.result.renewed = true;
    SC_ASSERT(t.stage.detection.curves.size() == world.rods.size() &&
                  t.stage.detection.outlines.size() == world.outlines.size(),
              "every rod and outline was looked at");
}

void detectAtEnd(const World& world, const Settings& settings, TrialStep& t) {
    t.enter(Stage::Detect, Stage::Integrate);
    SC_ASSERT(t.rods.size() == world.rods.size(), "one work space a rod");
    const double fall = world.gravity.norm() * t.dt * t.dt;
    t.kin.resize(t.rods.size());
    t.nextRange.resize(t.rods.size());
    for (std::size_t i = 0; i < t.rods.size(); ++i) {
        t.kin[i] = &t.rods[i].kin1;
        t.nextRange[i] = 2.0 * t.rods[i].moved + (t.rods[i].touching ? 0.0 : 4.0 * fall);
        SC_ASSERT(!(t.nextRange[i] < 0.0), "a range is not negative");
    }
    collide(world, t.kin, t.nextRange, t.dt, 4.0 * t.dt, settings.margin * t.h, t.stage, t.stage.after);
}

} // namespace supercircle::step
