// Stage Integrate: v = v_free + A^-1 H^T r, q1 = q + dt v, and how far everything moved.

#include "supercircle/step/parallel.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

/// Which rods carry a contact force. Held ones count too: the rows of holds are those of mid-step as well, so that how
/// far the rod may move is limited.
void markTouching(std::vector<RodWork>& rods, const ContactStage& stage) {
    for (RodWork& w : rods)
        w.touching = w.C.rows() > 0;
    for (std::size_t i = 0; i < stage.candidates.size(); ++i)
        if (stage.r[static_cast<Eigen::Index>(2 * i)] > 0.0) {
            rods[static_cast<std::size_t>(stage.candidates[i].a.rod)].touching = true;
            if (stage.candidates[i].b.rod >= 0)
                rods[static_cast<std::size_t>(stage.candidates[i].b.rod)].touching = true;
        }
}

/// Whether an element is curled up to more than a circle: its arc stands for no shell. No law of the material or of
/// its speed is asked: ropes are slow, whips are fast, and both are right.
bool excessiveCurvature(const rod::RodModel& model, const Eigen::VectorXd& q) {
    constexpr double kMostTurn = 2.0 * M_PI; // rad
    for (int i = 0; i < model.elements(); ++i)
        if (std::abs(q[model.dofOfElement(i)]) * model.elementLength(i) > kMostTurn)
            return true;
    return false;
}

/// Which rods are near another or an outline, or are carried by the machine.
void markNear(const World& world, const TrialStep& t, std::vector<char>& near) {
    near.clear();
    for (const Rod& r : world.rods)
        near.push_back(std::any_of(r.holds.begin(), r.holds.end(), [](const Hold& h) { return h.onCrosshead; }) ? 1
                                                                                                                : 0);
    for (const contact::Candidate& c : t.stage.candidates)
        for (const std::int32_t side : {c.a.rod, c.b.rod})
            if (side >= 0)
                near[static_cast<std::size_t>(side)] = 1;
}

/// The least length that limits the motion of a rod which is held and near nothing, over its own: only the rows of its
/// holds are those of mid-step, and no thickness matters to them. Half of it doubles the steps of a thin clamped rod
/// that swings, which damp it less; twice as much doubles what its held end strays, the square of the motion over R.
constexpr double kHeldShare = 0.012;

/// Largest error and motion; runaways; whether a rod came farther from its linearisation point than the range of the
/// candidates, which is then widened.
bool measure(const World& world, const Settings& settings, TrialStep& t) {
    t.error = t.moved = 0.0;
    t.result.runaways.clear();
    bool outOfRange = false;
    SC_ASSERT(t.result.range.size() == t.rods.size(), "one range a rod");
    std::vector<char>& near = t.stage.scratch.marked;
    markNear(world, t, near);
    for (std::size_t i = 0; i < t.rods.size(); ++i) {
        const RodWork& w = t.rods[i];
        const double relative = t.relative(t.lengths[i]);
        t.error = std::max(t.error, w.error * relative);
        const double least = near[i] ? 0.0 : kHeldShare * world.rods[i].model.definition().length;
        if (w.touching)
            t.moved = std::max(t.moved, w.moved * t.relative(std::max(t.lengths[i], least)));
        if (!w.frozen && excessiveCurvature(world.rods[i].model, w.q1))
            t.result.runaways.push_back(i);
        // Two rods share the margin: a fifth of it is left. A wider solution may go farther than this one.
        if (w.shift > t.result.range[i] + 0.4 * settings.margin * t.h) {
            outOfRange = true;
            t.result.range[i] = 1.5 * w.shift;
        }
    }
    return outOfRange;
}

/// Sleeping rods that are pressed on, and those in the island of a sleeping body that is. Side A of a contact with an
/// outline is awake: detection has no candidates of a sleeping rod and an outline.
void findPressedSleepers(const World& world, TrialStep& t) {
    t.result.sleepers.clear();
    for (std::size_t i = 0; i < t.stage.candidates.size(); ++i) {
        const contact::Candidate& c = t.stage.candidates[i];
        if (!(t.stage.r[static_cast<Eigen::Index>(2 * i)] > 0.0))
            continue;
        if (c.b.rod < 0) {
            const Body& b = world.bodies[static_cast<std::size_t>(t.stage.work[i].bodyB)];
            for (std::size_t rod = 0; b.asleep() && rod < world.rods.size(); ++rod)
                if (world.rods[rod].island == b.island)
                    t.result.sleepers.push_back(rod);
            continue;
        }
        for (const std::int32_t side : {c.a.rod, c.b.rod})
            if (const auto rod = static_cast<std::size_t>(side); world.rods[rod].asleep())
                t.result.sleepers.push_back(rod);
    }
}

} // namespace

void integrate(const World& world, TrialStep& t) {
    t.enter(Stage::Integrate, Stage::Solve);
    forEachRod(t.stage.loop, world.rods.size(), [&](std::size_t i) {
        if (t.rods[i].solved())
            advanceRod(world.rods[i], t.dt, t.rods[i]);
    });
    markTouching(t.rods, t.stage);
    for (std::size_t i = 0; i < t.rods.size(); ++i) {
        const RodWork& w = t.rods[i];
        SC_ASSERT(w.v.size() == world.rods[i].q.size() && w.q1.size() == w.v.size(), "state sizes are the rod's");
        SC_ASSERT(w.frozen == world.rods[i].frozen(), "quarantined and sleeping rods are frozen");
        SC_ASSERT(!(w.moved < 0.0) && !(w.shift < 0.0) && !(w.error < 0.0), "motion and error are lengths");
        SC_ASSERT_EXPENSIVE(!w.frozen || (w.v.isZero(0.0) && w.q1 == world.rods[i].q), "a frozen rod does not move");
    }
}

bool judgeMotion(const World& world, const Settings& settings, TrialStep& t, bool& wider) {
    SC_ASSERT(t.reached == Stage::Integrate, "a motion was found");
    constexpr int kMostWidenings = 4; // a motion that outruns every wider range needs a shorter step
    const bool adaptive = settings.fixedDt <= 0.0;
    const auto reject = [&](Reason reason) {
        t.result.reason = reason;
        return false;
    };
    if (!t.stage.report.error.empty()) // the solver refused the problem: nothing here was solved
        return reject(Reason::SolverFailed);
    for (const RodWork& w : t.rods)
        if (!w.v.allFinite())
            return reject(Reason::NotFinite);
    findPressedSleepers(world, t);
    if (!t.result.sleepers.empty())
        return reject(Reason::SleeperPressed);
    const bool outOfRange = measure(world, settings, t);
    // After that new candidates come from the end of the last linearisation.
    wider = outOfRange && t.first();
    if (wider)
        ++t.widenings;
    if (adaptive && t.dt > 2.0 * settings.dtMin) { // the smallest step stands with its error (Part::isSmallest)
        if (t.moved > settings.motionLimit * t.h)
            return reject(Reason::MotionTooLarge);
        if (t.error > 2.0 * settings.localError * t.h) // the controller aims at half of it
            return reject(Reason::LocalError);
    }
    if (adaptive && !t.result.runaways.empty())
        return reject(Reason::Runaway);
    if (wider && t.widenings > kMostWidenings)
        return reject(Reason::CandidatesTooFew);
    return true;
}

} // namespace supercircle::step
