#include "supercircle/step/stages/attempt.h"

#include "supercircle/step/contact_memory.h"
#include "supercircle/step/coupling/host_stage.h"
#include "supercircle/step/loads.h"
#include "supercircle/step/parallel.h"
#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/attraction_stage.h"
#include "supercircle/step/stages/contact_stiffness.h"
#include "supercircle/step/stages/effect_stage.h"
#include "supercircle/step/stages/friction_state.h"
#include "supercircle/step/stages/link_stage.h"
#include "supercircle/step/stages/prune.h"
#include "supercircle/step/stages/rod_stage.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

double deepest(const std::vector<contact::Candidate>& list) {
    double depth = 0.0;
    for (const contact::Candidate& c : list)
        depth = std::max(depth, -c.gap);
    return depth;
}

namespace {

struct GapErrors {
    double loaded = 0.0;  ///< largest |gap| of a loaded contact after the step, m
    double deepest = 0.0; ///< deepest overlap after the step, m
};

/// Contacts that give (contact_stage.h) are closed where their springs say.
GapErrors gapErrors(const World& world, const ContactStage& stage, const std::vector<ContactImpulse>& loaded) {
    GapErrors e;
    for (const contact::Candidate& c : stage.after) {
        const ContactImpulse* force = findImpulse(loaded, c.id);
        const double give = force != nullptr ? giveOf(world, c).x() * force->normal : 0.0;
        e.deepest = std::max(e.deepest, -(c.gap + give));
        if (force != nullptr)
            e.loaded = std::max(e.loaded, std::abs(c.gap + give));
    }
    return e;
}

/// Of longitudinal waves in the shell's material, sqrt(E / rho), m/s.
double soundSpeed(const rod::RodDefinition& d) {
    return std::sqrt(12.0 * d.bendingModulus / d.linearMass) / d.thickness;
}

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

} // namespace

void Attempt::useThreads(int count, const parallel::For& hostLoop) {
    if (hostLoop)
        stage.loop = hostLoop;
    else if (count != threads)
        stage.loop = threadLoop(count);
    threads = hostLoop ? 0 : count;
}

void Attempt::collidePresent(World& world, const Settings& settings) {
    bool known = world.range.size() == world.rods.size();
    for (std::size_t i = 0; known && i < world.rods.size(); ++i)
        known = world.range[i] >= 0.9 * world.rods[i].speed * dt;
    if (known)
        return;
    predictMotion(world, stage);
    const double fall = world.gravity.norm() * dt * dt;
    world.range.resize(world.rods.size());
    kin.resize(world.rods.size());
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        world.range[i] = 1.5 * world.rods[i].speed * dt + 2.0 * fall;
        kin[i] = &world.rods[i].kin;
    }
    collide(world, kin, world.range, 0.0, 2.0 * dt, settings.margin * h, stage, world.candidates);
}

/// What a step starts from: all candidates known, or those of them that matter.
const std::vector<contact::Candidate>& Attempt::startCandidates(const World& world, const Settings& settings) {
    stage.addBelow = settings.prune ? settings.margin * h : std::numeric_limits<double>::infinity();
    if (!settings.prune)
        return world.candidates;
    prune(world, dt, settings.margin * h, world.candidates, kept);
    return kept;
}

/// First linearisation: in the predicted middle of the step. Rods near others are not predicted farther than a quarter
/// of the thickness, so that no predicted frame can lie on the wrong side of a contact.
void Attempt::begin(const World& world, const Settings& settings) {
    std::vector<char>& near = stage.marked;
    near.assign(world.rods.size(), 0);
    for (const contact::Candidate& c : world.candidates) {
        near[static_cast<std::size_t>(c.a.rod)] = 1;
        if (c.b.rod >= 0)
            near[static_cast<std::size_t>(c.b.rod)] = 1;
    }
    forEachRod(stage.loop, world.rods.size(), [&](std::size_t i) {
        if (world.rods[i].frozen()) {
            freezeRod(world.rods[i], rods[i]);
            return;
        }
        const double farthest = near[i] ? 0.25 * h : std::numeric_limits<double>::infinity();
        beginAtPredictedMiddle(world.rods[i], dt, farthest, rods[i]);
    });
    predictMotion(world, stage);
    findLinkEnds(world, stage);
    beginHostRows(world, stage);
    frameInMiddle(world, rods, startCandidates(world, settings), false, dt, stage);
}

/// One turn of the contact solver, counted.
void Attempt::solveCoupled(World& world, const Settings& settings) {
    coulomb::SolverOptions options = settings.contact;
    if (stage.candidates.size() > settings.sweepAbove) {
        options.method = coulomb::Method::Accelerated;
        options.maxSweeps = settings.cappedSweeps;
    }
    solveContacts(world, rods, options, stage);
    ++world.counters.solves;
    contactsSolved += stage.candidates.size();
    world.counters.sweeps += static_cast<std::uint64_t>(stage.report.sweeps);
    world.counters.pivots += static_cast<std::uint64_t>(stage.report.pivots);
}

/// Stages evaluate, predict, couple and solve at the present linearisation, and the motion that follows.
void Attempt::solveOnce(World& world, const Settings& settings, StageTimes& times, bool first) {
    const std::size_t n = world.rods.size();
    {
        StageTimer timer(times, Stage::Evaluate);
        collectRolling(world, rods, dt, impulses, first, stage);
        collectAxial(world, rods, impulses, stage);
        collectPulls(world, rods, dt, stage);
        forEachRod(stage.loop, n, [&](std::size_t i) {
            if (rods[i].frozen)
                return;
            evaluateRod(world, world.rods[i], dt, first, rods[i]);
            addPulls(stage, static_cast<int>(i), dt, rods[i]);
        });
    }
    {
        StageTimer timer(times, Stage::Predict);
        forEachRod(stage.loop, n, [&](std::size_t i) {
            if (!rods[i].frozen)
                predictRod(world.rods[i], rods[i]);
        });
    }
    {
        StageTimer timer(times, Stage::Couple);
        couple(world, rods, dt, impulses, !first, stage);
        applyFrictionState(world, rods, dt, !first, stage);
    }
    {
        StageTimer timer(times, Stage::Solve);
        solveCoupled(world, settings);
        for (int again = 0; again < 3 && boundHostRows(world, dt, stage); ++again) {
            renewHostBlocks(world, dt, stage);
            solveCoupled(world, settings);
        }
        constexpr int kMostFactors = 25; // false position halves at worst every second turn
        for (int turn = 0; turn < kMostFactors && refineFriction(world, rods, dt, stage); ++turn)
            solveCoupled(world, settings);
    }
    StageTimer timer(times, Stage::Advance);
    forEachRod(stage.loop, n, [&](std::size_t i) {
        if (!rods[i].frozen)
            advanceRod(world.rods[i], dt, rods[i]);
    });
    markTouching(rods, stage);
}

/// Whether an element turns far more often than a shell can: motion at the end of its numbers.
[[nodiscard]] static bool curledUp(const rod::RodModel& model, const Eigen::VectorXd& q) {
    constexpr double kMostTurn = 16.0 * M_PI;
    for (int i = 0; i < model.elements(); ++i)
        if (std::abs(q[model.dofOfElement(i)]) * model.elementLength(i) > kMostTurn)
            return true;
    return false;
}

/// How far everything moved, and whether the candidates reached that far; if not, the world's range is widened.
Attempt::Reach Attempt::measure(World& world, const Settings& settings, int& widened, bool first) {
    error = moved = 0.0;
    runaways.clear();
    bool outOfRange = false;
    for (std::size_t i = 0; i < rods.size(); ++i) {
        const RodWork& w = rods[i];
        error = std::max(error, w.error);
        if (w.touching)
            moved = std::max(moved, w.moved);
        if (!world.rods[i].quarantined && (w.moved > dt * soundSpeed(world.rods[i].model.definition()) ||
                                           (!w.frozen && curledUp(world.rods[i].model, w.q1))))
            runaways.push_back(i);
        if (w.shift > world.range[i] + 0.4 * settings.margin * h) {
            outOfRange = true;
            world.range[i] = 1.5 * w.shift;
        }
    }
    if (!outOfRange)
        return Reach::Enough;
    if (!first)
        return Reach::Enough; // relinearised: new candidates come from the end of the last attempt
    return ++widened > 4 ? Reach::Never : Reach::Wider;
}

/// Candidates at the end of the attempt: what judges it, and what the next step starts from (at most twice as long).
void Attempt::collideEnd(const World& world, const Settings& settings) {
    const double fall = world.gravity.norm() * dt * dt;
    kin.resize(rods.size());
    nextRange.resize(rods.size());
    for (std::size_t i = 0; i < rods.size(); ++i) {
        kin[i] = &rods[i].kin1;
        nextRange[i] = 2.0 * rods[i].moved + (rods[i].touching ? 0.0 : 4.0 * fall);
    }
    collide(world, kin, nextRange, dt, 4.0 * dt, settings.margin * h, stage, stage.after);
}

/// The independent check of the way from start to end.
void Attempt::witness(const World& world) {
    placeOutlines(world, stage.motion, 0.0, 0.0, stage.outlineKeys, outlinesBefore);
    curvesBefore.resize(world.rods.size());
    parallel::forEach(stage.loop, world.rods.size(), 32,
                      [&](std::size_t i) { toCurve(world.rods[i], world.rods[i].kin, curvesBefore[i]); });
    contact::findCrossingsSwept(curvesBefore, stage.curves, outlinesBefore, stage.outlines, crossings, stage.loop);
    const auto out = [&](std::int32_t rod) {
        return rod >= 0 && world.rods[static_cast<std::size_t>(rod)].quarantined;
    };
    std::erase_if(crossings, [&](const contact::Crossing& c) {
        return out(c.rodA) || out(c.rodB) || excluded(world, stage, c.rodA, c.rodB, c.outline);
    });
}

/// Whether links, grabs or effects ask for another linearisation.
bool Attempt::partsOff(const World& world, double tolerance) const {
    for (std::size_t i = 0; i < rods.size(); ++i)
        if (!rods[i].frozen && (grabsOff(world.rods[i], dt, rods[i]) ||
                                (world.rods[i].effects.on() && effectError(world.rods[i], dt, rods[i]) > 1.0)))
            return true;
    return frictionError(world, rods, dt, stage) > 1.0 || pullError(world, rods, dt, stage) > 1.0 ||
           linkError(world, rods, dt, tolerance, stage) > 1.0;
}

/// Wakes the sleepers that somebody pressed on; false if nobody did.
bool Attempt::wakeTouched(World& world) const {
    bool any = false;
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const contact::Candidate& c = stage.candidates[i];
        if (c.b.rod < 0 || !(stage.r[static_cast<Eigen::Index>(2 * i)] > 0.0))
            continue;
        for (const std::int32_t side : {c.a.rod, c.b.rod})
            if (const auto rod = static_cast<std::size_t>(side); world.rods[rod].asleep()) {
                wake(world, rod);
                any = true;
            }
    }
    return any;
}

Verdict Attempt::solve(World& world, const Settings& settings, StageTimes& times,
                       const std::function<void(const coulomb::Problem&, const coulomb::SolveReport&)>& onSolve) {
    const bool adaptive = settings.fixedDt <= 0.0;
    const double before = deepest(world.candidates);
    crossings.clear();
    contactsSolved = 0;
    rejectedBeforeEnd = true;
    rods.resize(world.rods.size());
    impulses = world.impulses;
    stage.overlap = 2.0 * settings.rejectPenetration * h;
    stage.closes = adaptive ? settings.localError * h : std::numeric_limits<double>::infinity();
    stage.recovery = settings.recovery * h;
    begin(world, settings);
    int widened = 0;
    for (int iteration = 0;;) {
        solveOnce(world, settings, times, iteration == 0);
        if (onSolve && !stage.problem.contacts.empty())
            onSolve(stage.problem, stage.report);
        if (!stage.report.error.empty()) // the solver refused the problem: nothing here was solved
            return Verdict::Smaller;
        for (const RodWork& w : rods)
            if (!w.v.allFinite())
                return Verdict::Smaller;
        if (wakeTouched(world))
            return Verdict::Woken;
        const Reach reach = measure(world, settings, widened, iteration == 0);
        const bool tooFar = adaptive && (moved > settings.motionLimit * h || error > 2.0 * settings.localError * h);
        if (tooFar && dt > 2.0 * settings.dtMin)
            return Verdict::Smaller;
        if (adaptive && !runaways.empty())
            return Verdict::Smaller;
        if (reach == Reach::Never)
            return Verdict::Smaller;
        StageTimer timer(times, Stage::Collide);
        if (reach == Reach::Wider) {
            kin.resize(rods.size());
            for (std::size_t i = 0; i < rods.size(); ++i)
                kin[i] = &world.rods[i].kin;
            predictMotion(world, stage);
            collide(world, kin, world.range, 0.0, 2.0 * dt, settings.margin * h, stage, world.candidates);
            begin(world, settings);
            continue;
        }
        collideEnd(world, settings);
        gather(stage, dt, impulses);
        const GapErrors e = gapErrors(world, stage, impulses);
        const double reject = settings.rejectPenetration * h, tolerance = settings.relinearise * h;
        const bool deeper = e.deepest > reject && e.deepest > before + 0.1 * reject;
        const bool off = e.loaded > tolerance || (e.deepest > tolerance && e.deepest > before);
        if ((deeper || off || partsOff(world, tolerance)) && ++iteration < settings.maxIterations) {
            forEachRod(stage.loop, rods.size(), [&](std::size_t i) {
                if (!rods[i].frozen)
                    relineariseInMiddle(world.rods[i], rods[i]);
            });
            frameInMiddle(world, rods, settings.prune ? kept : world.candidates, true, dt, stage);
            for (std::size_t i = 0; i < rods.size(); ++i)
                world.range[i] = std::max(world.range[i], nextRange[i]);
            continue;
        }
        rejectedBeforeEnd = false;
        if (deeper && (adaptive || e.deepest > 0.25 * h))
            return Verdict::Smaller;
        if (const LinkGaps g = linkGaps(world, rods, dt, stage);
            adaptive && g.after > reject && g.after > 1.1 * g.before)
            return Verdict::Smaller;
        if (settings.witness)
            witness(world);
        return crossings.empty() ? Verdict::Accept : Verdict::Smaller;
    }
}

} // namespace supercircle::step
