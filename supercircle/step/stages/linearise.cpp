// Stage Linearise: rows H = dg/dq of contacts and joints, first in the predicted middle of the step, then in the middle
// of the motion that was found, as long as the nonlinear balance does not hold.

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/contact_memory.h"
#include "supercircle/step/contacts/adhesion.h"
#include "supercircle/step/contacts/contact_stiffness.h"
#include "supercircle/step/contacts/cull.h"
#include "supercircle/step/contacts/friction_state.h"
#include "supercircle/step/contacts/link_rows.h"
#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/coupling/host_rows.h"
#include "supercircle/step/parallel.h"
#include "supercircle/step/rods/effect_terms.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

struct GapErrors {
    double loaded = 0.0;  ///< largest |gap| of a loaded contact after the step, in lengths of its pair, times h, m
    double deepest = 0.0; ///< deepest overlap after the step, likewise, m
};

/// Compliant contacts (contact_rows.h) are closed where their springs say.
GapErrors gapErrors(const World& world, const TrialStep& t, const std::vector<ContactImpulse>& loaded) {
    GapErrors e;
    for (const contact::Candidate& c : t.stage.after) {
        if (isOverlap(world, c.a.rod, c.b.rod, c.outline, false) || withinJoined(world, c.a.rod, c.outline))
            continue; // it is deep already, or comes to be when its contacts act again
        const double relative = t.relative(lengthOf(world, t.stage.length, c));
        const ContactImpulse* force = findImpulse(loaded, c.id);
        const double give = force != nullptr ? complianceOf(world, c).x() * force->normal : 0.0;
        e.deepest = std::max(e.deepest, -(c.gap + give) * relative);
        if (force != nullptr)
            e.loaded = std::max(e.loaded, std::abs(c.gap + give) * relative);
    }
    return e;
}

/// What a step starts from: all candidates known, or those of them that matter.
const std::vector<contact::Candidate>& startCandidates(const World& world, const Settings& settings, TrialStep& t) {
    t.stage.addBelow = settings.cull ? settings.margin * t.h : std::numeric_limits<double>::infinity();
    t.stage.leavesTips = settings.leavesTips();
    if (!t.selects(settings))
        return t.candidates(world);
    if (!settings.cull)
        t.kept = t.candidates(world);
    std::erase_if(
        t.kept, [&](const contact::Candidate& c) { return isOfFreeRod(t.rods, c) || isOfFreeBody(world, t.stage, c); });
    return t.kept;
}

/// Whether forces bring in energy because their rows turn.
bool forcesTurn(const World& world, TrialStep& t) {
    bool any = false;
    for (std::size_t i = 0; i < t.rods.size(); ++i)
        any = (t.rods[i].solved() && turnsTooMuch(world.rods[i], t.dt, t.rods[i])) || any;
    return any;
}

/// Whether links, mouse joints or effects ask for another linearisation.
bool jointsOrEffectsOff(const World& world, double tolerance, const TrialStep& t) {
    const std::vector<RodWork>& rods = t.rods;
    const ContactStage& stage = t.stage;
    const double dt = t.dt;
    for (std::size_t i = 0; i < rods.size(); ++i)
        if (rods[i].solved() && (mouseJointsOff(world.rods[i], dt, rods[i]) ||
                                 (world.rods[i].effects.on() && effectError(world.rods[i], dt, rods[i]) > 1.0)))
            return true;
    return frictionError(world, rods, dt, stage) > 1.0 || adhesionError(world, rods, dt, stage) > 1.0 ||
           linkError(world, rods, dt, tolerance, stage) > 1.0;
}

} // namespace

/// Rods near others are not predicted farther than a quarter of the thickness, so that no predicted frame can lie on
/// the wrong side of a contact.
void linearise(const World& world, const Settings& settings, TrialStep& t) {
    t.enter(Stage::Linearise, Stage::Detect);
    ContactStage& stage = t.stage;
    predictMotion(world, stage);
    findLinkEnds(world, stage);
    if (settings.cull || settings.secondOrder)
        cull(world, t.dt, settings.margin * t.h, t.candidates(world), t.kept);
    moveFreeRods(world, settings, t);
    std::vector<char>& near = stage.scratch.marked;
    near.assign(world.rods.size(), 0);
    for (const contact::Candidate& c : t.candidates(world)) {
        SC_ASSERT(invariants::inRange(c.a.rod, near.size()) && c.b.rod < static_cast<std::int32_t>(near.size()),
                  "a candidate names rods of the world");
        near[static_cast<std::size_t>(c.a.rod)] = 1;
        if (c.b.rod >= 0)
            near[static_cast<std::size_t>(c.b.rod)] = 1;
    }
    forEachRod(stage.loop, world.rods.size(), [&](std::size_t i) {
        if (world.rods[i].frozen()) {
            freezeRod(world.rods[i], t.rods[i]);
            return;
        }
        if (t.rods[i].isFree)
            return;
        const double farthest = near[i] ? 0.25 * t.lengths[i] : std::numeric_limits<double>::infinity();
        beginAtPredictedMiddle(world.rods[i], t.dt, farthest, t.rods[i]);
    });
    beginHostRows(world, stage);
    frameInMiddle(world, t.rods, startCandidates(world, settings, t), false, t.dt, stage);
    SC_ASSERT(stage.candidates.size() == stage.gapAtStart.size(), "one gap a candidate");
    SC_ASSERT(stage.host.saturated.size() == world.constraints.rows.size(), "one state a row of the host");
}

bool relinearise(const World& world, const Settings& settings, TrialStep& t) {
    t.enter(Stage::Linearise, Stage::Detect);
    SC_ASSERT(t.nextRange.size() == t.rods.size() && t.result.range.size() == t.rods.size(), "one range a rod");
    const bool adaptive = settings.fixedDt <= 0.0;
    gather(t.stage, t.dt, t.impulses);
    const GapErrors e = gapErrors(world, t, t.impulses);
    const double reject = settings.rejectPenetration * t.h, tolerance = settings.relinearise * t.h;
    const bool deeper = e.deepest > reject && e.deepest > t.overlapAtStart + 0.1 * reject;
    const bool off = e.loaded > tolerance || (e.deepest > tolerance && e.deepest > t.overlapAtStart);
    const bool turning = forcesTurn(world, t);
    const bool inAHurry = t.result.work.units() >= t.hurryAt;
    if ((deeper || off || turning || jointsOrEffectsOff(world, tolerance, t)) && !inAHurry &&
        ++t.linearisations < settings.maxIterations) {
        forEachRod(t.stage.loop, t.rods.size(), [&](std::size_t i) {
            if (t.rods[i].solved())
                relineariseInMiddle(world.rods[i], t.rods[i]);
        });
        frameInMiddle(world, t.rods, t.selects(settings) ? t.kept : t.candidates(world), true, t.dt, t.stage);
        for (std::size_t i = 0; i < t.rods.size(); ++i)
            t.result.range[i] = std::max(t.result.range[i], t.nextRange[i]);
        return true;
    }
    SC_ASSERT(t.linearisations <= settings.maxIterations, "linearisations are bounded");
    t.result.judged = true;
    if (deeper && (adaptive || e.deepest > 0.25 * t.h))
        t.result.reason = Reason::Penetration;
    else if (const LinkGaps g = linkGaps(world, t.rods, t.dt, t.stage);
             adaptive && g.after > reject && g.after > 1.1 * g.before)
        t.result.reason = Reason::LinkGap;
    else if (turning && adaptive)
        t.result.reason = Reason::LocalError;
    return false;
}

} // namespace supercircle::step
