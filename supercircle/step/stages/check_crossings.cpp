// Stage CheckCrossings: no centre line crosses another one or enters a solid on its way from start to end. A pair that
// crosses at the start has not got there by its motion: no step is short enough for it, and it becomes an overlap.

#include "supercircle/step/contacts/excluded_pairs.h"
#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::step {

namespace {

/// Takes down a pair if it crosses at the start of the step. True: it does.
bool testAtStart(const World& world, const Overlap& pair, std::vector<Overlap>& found) {
    const auto same = [&](const Overlap& o) { return o.pair() == pair.pair(); };
    if (std::any_of(found.begin(), found.end(), same))
        return true;
    if (!overlapsNow(world, pair))
        return false;
    found.push_back(pair);
    return true;
}

} // namespace

void findOverlaps(const World& world, TrialStep& t) {
    // No step leaves contacts as deep as this. Half of it would ask about shells that lie deep in each other without
    // crossing, twice of it would leave crossing ones to the end of the step, which their contacts do not let them
    // reach.
    constexpr double kDeep = 0.5; // of the half thicknesses
    if (t.overlapAtStart < kDeep * 0.5 * t.h)
        return;
    const auto half = [&](std::int32_t rod) {
        return rod < 0 ? 0.0 : 0.5 * world.rods[static_cast<std::size_t>(rod)].model.definition().thickness;
    };
    for (const contact::Candidate& c : t.candidates(world))
        if (-c.gap >= kDeep * (half(c.a.rod) + half(c.b.rod)) &&
            !isOverlap(world, c.a.rod, c.b.rod, c.outline, false)) {
            contact::Crossing at;
            at.rodA = c.a.rod;
            at.rodB = c.b.rod;
            at.outline = c.outline;
            (void)testAtStart(world, overlapOf(world, at), t.result.overlaps);
        }
    if (!t.result.overlaps.empty())
        t.result.reason = Reason::Crossing;
}

void checkCrossings(const World& world, TrialStep& t) {
    t.enter(Stage::CheckCrossings, Stage::Linearise);
    ContactStage& stage = t.stage;
    std::vector<contact::Crossing>& crossings = t.result.crossings;
    placeOutlines(world, stage.host.motion, 0.0, 0.0, stage.scratch.outlineKeys, t.outlinesBefore);
    t.curvesBefore.resize(world.rods.size());
    parallel::forEach(stage.loop, world.rods.size(), 32,
                      [&](std::size_t i) { toCurve(world.rods[i], world.rods[i].kin, t.curvesBefore[i]); });
    SC_ASSERT(t.curvesBefore.size() == stage.detection.curves.size() &&
                  t.outlinesBefore.size() == stage.detection.outlines.size(),
              "the same rods and outlines before and after");
    contact::CheckEffort effort{.maxWork = t.checkWorkLeft(), .bounded = true};
    contact::findCrossingsSwept(t.curvesBefore, stage.detection.curves, t.outlinesBefore, stage.detection.outlines,
                                crossings, stage.loop, &effort);
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
        return out(c.rodA) || out(c.rodB) || excluded(world, stage, c.rodA, c.rodB, c.outline) ||
               isOverlap(world, c.rodA, c.rodB, c.outline, false);
    };
    std::erase_if(crossings, permitted);
    std::erase_if(effort.unjudged, permitted);
    for (const contact::Crossing& c : crossings) {
        const Overlap pair = overlapOf(world, c);
        if (!testAtStart(world, pair, t.result.overlaps) && withinJoined(world, c.rodA, c.outline))
            t.result.overlaps.push_back(pair);
    }
    if (!crossings.empty() || !effort.unjudged.empty())
        t.result.reason = Reason::Crossing;
}

} // namespace supercircle::step
