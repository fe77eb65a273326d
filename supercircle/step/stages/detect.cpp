// Stage Detect: pairs whose gap g(q) may close within the step.

#include "supercircle/step/stages/stages.h"

#include <algorithm>

namespace supercircle::step {

double deepest(const std::vector<contact::Candidate>& list) {
    double depth = 0.0;
    for (const contact::Candidate& c : list)
        depth = std::max(depth, -c.gap);
    return depth;
}

void detectAtStart(const World& world, const Settings& settings, TrialStep& t) {
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
    t.kin.resize(world.rods.size());
    for (std::size_t i = 0; i < world.rods.size(); ++i)
        t.kin[i] = &world.rods[i].kin;
    predictMotion(world, t.stage);
    collide(world, t.kin, t.result.range, 0.0, 2.0 * t.dt, settings.margin * t.h, t.stage, t.result.candidates);
    t.result.renewed = true;
}

void detectAtEnd(const World& world, const Settings& settings, TrialStep& t) {
    const double fall = world.gravity.norm() * t.dt * t.dt;
    t.kin.resize(t.rods.size());
    t.nextRange.resize(t.rods.size());
    for (std::size_t i = 0; i < t.rods.size(); ++i) {
        t.kin[i] = &t.rods[i].kin1;
        t.nextRange[i] = 2.0 * t.rods[i].moved + (t.rods[i].touching ? 0.0 : 4.0 * fall);
    }
    collide(world, t.kin, t.nextRange, t.dt, 4.0 * t.dt, settings.margin * t.h, t.stage, t.stage.after);
}

} // namespace supercircle::step
