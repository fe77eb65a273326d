// The controller: sizes of steps, what becomes of a trial, the frame around it. The step itself is in step.cpp.

#include "supercircle/step/stepper.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/contacts/overlaps.h"
#include "supercircle/step/contacts/pair_vetoes.h"
#include "supercircle/step/crush.h"
#include "supercircle/step/energy_gain.h"
#include "supercircle/step/gap_energy.h"
#include "supercircle/step/islands/island.h"
#include "supercircle/step/second_order.h"
#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/fingerprint.h"
#include "supercircle/step/stages/frame_budget.h"
#include "supercircle/step/stages/stages.h"
#include "supercircle/support/elementary.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

constexpr std::int64_t kTicks = std::int64_t{1} << 24; ///< a frame is divided into powers of two of this
constexpr int kGiveUp = 40;                            ///< cuts in a row
constexpr int kCutsToCrush = 3;      ///< one would take hard steps for contradictions, many waste the frame
constexpr int kCutsToFullEffort = 4; ///< half of it spends long solves on steps that are cut anyway; twice as much
                                     ///< makes steps 16 times shorter before a hard problem is solved

/// Longest power-of-two part of the frame that is no longer than `want` seconds and than what is left.
std::int64_t ticksFor(double want, double frame, std::int64_t left) {
    std::int64_t ticks = kTicks;
    while (ticks > 1 && (ticks > left || static_cast<double>(ticks) / kTicks * frame > want * (1.0 + 1e-9)))
        ticks /= 2;
    SC_ASSERT(ticks >= 1 && ticks <= left, "a step is a part of what is left of the frame");
    return ticks;
}

/// Step size the controller wants next.
double wantedSize(const World& world, const Settings& s, double frame, int cuts) {
    const bool still = std::all_of(world.rods.begin(), world.rods.end(), [](const Rod& r) { return r.frozen(); });
    if (still)
        return frame;
    return s.fixedDt > 0.0 ? s.fixedDt * math::pow(0.5, cuts) : std::clamp(world.dtNext, s.dtMin, s.dtMax);
}

/// Step size the controller wants after an accepted step.
double nextSize(const Settings& s, const TrialStep& t, double growth) {
    if (s.fixedDt > 0.0)
        return s.fixedDt;
    const double byError = 0.9 * std::sqrt(s.localError * t.h / std::max(t.error, 1e-300));
    const double byMotion = 0.75 * s.motionLimit * t.h / std::max(t.moved, 1e-300);
    return t.dt * std::clamp(std::min(byError, byMotion), 0.25, growth);
}

void addSolves(const TrialResult& r, Counters& counters) {
    counters.solves += r.solves;
    counters.gaussSeidelIterations += r.gaussSeidelIterations;
    counters.pivots += r.pivots;
}

/// Takes over what a trial returns whether or not it is accepted: counters, reach of the candidates, sleepers to wake.
void adopt(World& world, TrialResult& r) {
    addSolves(r, world.counters);
    if (r.renewed)
        std::swap(world.candidates, r.candidates);
    r.renewed = false;
    std::swap(world.range, r.range);
    SC_ASSERT(world.range.size() == world.rods.size(), "one range a rod");
    for (const std::size_t rod : r.sleepers)
        if (world.rods[rod].asleep())
            wake(world, rod);
    addOverlaps(world, r.overlaps);
}

void countRejection(World& world, Reason reason) {
    SC_ASSERT(reason > Reason::None && reason < Reason::Count, "a rejection has a reason");
    ++world.counters.rejected;
    ++world.counters.rejectedFor[static_cast<std::size_t>(reason)];
}

/// Takes out of the law what no step size can help. True if there was something: the others go on without it. Shells
/// with an element curled up to more than a circle stop; pairs that cross even in the smallest step are apart.
bool takeOutHopeless(World& world, const TrialResult& r) {
    if (!r.runaways.empty()) {
        SC_ASSERT(r.runaways.back() < world.rods.size(), "a runaway is a rod of the world");
        for (const std::size_t i : r.runaways)
            quarantine(world, world.rods[i], QuarantineReason::Runaway);
        return true;
    }
    if (!r.judged || r.crossings.empty())
        return false;
    world.counters.crossings += r.crossings.size();
    for (const contact::Crossing& c : r.crossings)
        addOverlaps(world, {overlapOf(world, c)});
    return true;
}

/// What contradictions ask for.
enum class Contradiction : std::uint8_t {
    None,
    Ended, ///< the step is tried again
    Stops  ///< something has to stop: the frame ends here
};

/// Ends contradictions that keep a trial from being feasible (crush.h). A contact problem that the solver has solved
/// contradicts nothing, and one that it gave up says nothing, unless forces diverge.
Contradiction endContradiction(World& world, const Settings& s, const TrialStep& t, Reason reason, int cuts,
                               FrameResult& out) {
    const bool infeasible = !t.stage.report.converged && t.fullEffort &&
                            (reason == Reason::None || reason == Reason::Unconverged || reason == Reason::Penetration ||
                             reason == Reason::LinkGap || reason == Reason::Crossing);
    const bool cut = cuts >= kCutsToCrush || t.dt <= math::pow(2.0, kCutsToCrush) * s.dtMin;
    if (s.crush == CrushPolicy::Wait || !((infeasible && cut) || forcesDiverge(world, t)))
        return Contradiction::None;
    std::vector<Crushed> crushed;
    findCrushed(world, t, crushed);
    addCrushed(out.crushed, crushed);
    if (endCrushing(world, s, crushed))
        return Contradiction::Stops;
    return crushed.empty() ? Contradiction::None : Contradiction::Ended;
}

/// Cuts in a row that the last frame left, of the rods that step together.
int cutsOf(const World& world) {
    int most = 0;
    for (const Rod& r : world.rods)
        most = std::max(most, r.cuts);
    return most;
}

/// Why the simulation cannot go on with this trial; empty if it may become the next state.
std::string whyNot(const TrialStep& t) {
    const bool finite =
        std::all_of(t.rods.begin(), t.rods.end(), [](const RodWork& w) { return w.v.allFinite() && w.q1.allFinite(); });
    if (!finite)
        return "the contact solver returned numbers that are not finite";
    if (!t.result.judged)
        return "the step size fell to its minimum without an acceptable step";
    return t.result.crossings.empty() ? "" : "shells would cross even at the smallest step";
}

/// A function as an observer of whole worlds; an empty one watches nothing.
class FunctionObserver : public FrameObserver {
public:
    explicit FunctionObserver(const std::function<bool(const World&)>& function) : function_(function) {}
    [[nodiscard]] bool wantsWholeWorld() const override { return static_cast<bool>(function_); }
    bool afterStep(const World& stepped) override { return function_ && function_(stepped); }

private:
    const std::function<bool(const World&)>& function_;
};

/// Islands cannot be told apart where the machine, one list of energies or a given step serves all shells.
bool indivisible(const World& world, const Settings& settings) {
    return settings.fixedDt > 0.0 || !world.crossheadBodies.empty() || !world.crossheadVelocity.isZero(0.0) ||
           std::any_of(world.rods.begin(), world.rods.end(), [](const Rod& r) {
               return r.effects.surface.model.compliant() ||
                      std::any_of(r.holds.begin(), r.holds.end(), [](const Hold& h) { return h.onCrosshead; });
           });
}

} // namespace

bool Stepper::Part::isSmallest(const Settings& s) const {
    return trial.dt <= 2.0 * s.dtMin || ticks == 1 || cuts >= kGiveUp;
}

Stepper::Stepper(Settings settings) : settings_(settings), work_(std::make_unique<Work>()) {}
Stepper::~Stepper() = default;

const coulomb::Problem& Stepper::lastProblem() const {
    return work_->last->stage.problem;
}
const std::vector<contact::Candidate>& Stepper::lastCandidates() const {
    return work_->last->stage.candidates;
}
const Eigen::VectorXd& Stepper::lastImpulses() const {
    return work_->last->stage.r;
}
double Stepper::lastDt() const {
    return work_->lastDt;
}

void Stepper::readHost(World& world, const Port& port, double frame) const {
    step::readHost(world, port, settings_, frame, false, work_->reading);
}

void Stepper::learnFromHost(World& world, Port& port, double advanced) const {
    step::learnFromHost(world, settings_, pairFilter, port, advanced, work_->coupling);
}

/// Why the trial must not become the next state; `cuts` in a row so far. An unconverged contact problem is tried at
/// half the size twice, or until the solver may make its full effort, before it is taken as it is and counted.
Reason Stepper::rejection(const TrialStep& t, int cuts, bool inAHurry) const {
    if (t.result.reason != Reason::None)
        return t.result.reason;
    const bool gaveUp = settings_.giveUpEarly && !t.fullEffort && t.stage.candidates.size() <= settings_.sweepAbove;
    const bool asItIs = gaveUp ? inAHurry : settings_.acceptUnconverged || cuts >= 2;
    return t.stage.report.converged || asItIs || settings_.fixedDt > 0.0 ? Reason::None : Reason::Unconverged;
}

/// What becomes of a trial that was made.
enum class Stepper::Verdict : std::uint8_t {
    Accept, ///< it is the next state
    Repeat, ///< another one is made
    End     ///< the frame ends here
};

/// Whether a motion of the part leaves the regions that were read.
Stepper::Verdict Stepper::judgeRegions(Part& part, const TrialStep& moved, double elapsed, Port* port) {
    World& world = part.world;
    if ((!port && !part.partition) || !leavesRegions(world, moved, part.frame - elapsed, part.reading))
        return Verdict::Accept;
    if (part.rodsMeetOthers())
        return Verdict::End;
    if (!port || !readAgain(world, *port, settings_, part.frame, elapsed, part.reading))
        return Verdict::Accept;
    updateVetoes(world, part.frame, pairFilter);
    countRejection(world, Reason::OutsideRegion);
    return Verdict::Repeat;
}

/// Takes over what the trial returns, and judges it. `elapsed`: of the frame before the trial, s.
Stepper::Verdict Stepper::judge(Part& part, double elapsed, Port* port, FrameBudget& budget, FrameResult& out) {
    World& world = part.world;
    TrialStep& trial = part.trial;
    adopt(world, trial.result);
    const double spent = trial.result.work.units();
    const Reason reason = rejection(trial, part.cuts, budget.hurries(spent));
    budget.spend(spent);
    out.budgetExhausted = trial.result.outOfWork || budget.exhausted();
    if (trial.result.outOfWork)
        return Verdict::End;
    if (trial.result.judged)
        if (const Verdict v = judgeRegions(part, trial, elapsed, port); v != Verdict::Accept)
            return v;
    if (reason == Reason::SleeperPressed || !trial.result.overlaps.empty()) {
        countRejection(world, reason);
        return Verdict::Repeat;
    }
    if (const Contradiction found = endContradiction(world, settings_, trial, reason, part.cuts, out);
        found != Contradiction::None) {
        countRejection(world, reason == Reason::None ? Reason::Unconverged : reason);
        part.cuts = part.unsolved = 0;
        return found == Contradiction::Stops ? Verdict::End : Verdict::Repeat;
    }
    if (reason != Reason::None && !part.isSmallest(settings_)) {
        countRejection(world, reason);
        ++part.cuts;
        part.unsolved += trial.stage.report.converged ? 0 : 1;
        world.dtNext = 0.5 * trial.dt;
        return Verdict::Repeat;
    }
    if (settings_.fixedDt <= 0.0 && takeOutHopeless(world, trial.result)) {
        part.cuts = part.unsolved = 0;
        return Verdict::Repeat;
    }
    out.failure = whyNot(trial);
    if (out.failure.empty())
        return Verdict::Accept;
    world.counters.crossings += trial.result.crossings.size();
    return Verdict::End;
}

/// Replaces a trial that may be accepted by a step of second order, where that is worth it and can be made. `made`: it
/// has become the state.
Stepper::Verdict Stepper::refine(Part& part, double elapsed, Port* port, FrameBudget& budget, bool& made) {
    TrialStep& trial = part.trial;
    made = false;
    if (budget.hurries(2.0 * trial.result.work.units()))
        return Verdict::Accept;
    const double before = trial.result.work.units();
    trial.result.solves = trial.result.gaussSeidelIterations = trial.result.pivots = 0; // counted already
    const SecondOrder found = trySecondOrder(part.world, budget.settings(), trial, times_, onSolve);
    addSolves(trial.result, part.world.counters);
    if (found == SecondOrder::Made)
        addSolves(trial.result, trial.secondOrder->world.counters);
    budget.spend(trial.result.work.units() - before);
    if (found == SecondOrder::Made) {
        made = true;
        return judgeRegions(part, trial.secondOrder->stages[1], elapsed, port);
    }
    if (found == SecondOrder::NotWorth)
        return Verdict::Accept;
    const bool shortest = trial.dt <= settings_.dtMax / settings_.secondOrderParts || part.isSmallest(settings_);
    if (shortest || budget.exhausted())
        return Verdict::Accept;
    countRejection(part.world, found == SecondOrder::StatusChanged ? Reason::StatusChange : Reason::LocalError);
    part.world.dtNext = 0.5 * trial.dt;
    return Verdict::Repeat;
}

/// Steps a part through the frame.
FrameResult Stepper::advancePart(Part& part, double frame, Port* port, FrameObserver& observer) {
    FrameResult out;
    World& world = part.world;
    TrialStep& trial = part.trial;
    trial.h = settings_.length > 0.0 ? settings_.length : world.rods.empty() ? 1e-3 : thinnest(world);
    trial.useThreads(settings_.threads, loop);
    if (world.dtNext <= 0.0)
        world.dtNext = settings_.dtMax / 16.0;
    work_->last = &trial;
    trial.stage.gaps = {};
    observer.begin(world);
    const double start = world.time;
    const EnergyBalance balance = world.energyBalance;
    FrameBudget budget(settings_, world, part.budget, part.budgeted);
    part.frame = frame;
    part.cuts = part.unsolved = cutsOf(world); // the last frame had no time for more
    std::int64_t left = kTicks;
    while (left > 0 && out.failure.empty() && !out.stopped && !out.budgetExhausted) {
        part.ticks = ticksFor(wantedSize(world, settings_, frame, part.cuts), frame, left);
        trial.dt = frame * static_cast<double>(part.ticks) / kTicks;
        const Settings& settings = budget.settings();
        trial.workLimit = budget.trialLimit();
        trial.solveLimit = budget.solveLimit();
        trial.hurryAt = budget.hurryAt();
        trial.fullEffort = !settings_.giveUpEarly || part.unsolved >= kCutsToFullEffort;
        SC_ASSERT(trial.dt > 0.0 && trial.dt <= frame, "a step is a part of the frame");
        const std::uint64_t before = invariants::kExpensive ? fingerprint(world) : 0;
        tryStep(world, settings, trial, times_, onSolve);
        SC_ASSERT_EXPENSIVE(before == fingerprint(world), "a trial changes nothing of the world");
        (void)before;
        Verdict verdict = judge(part, world.time - start, port, budget, out);
        if (verdict == Verdict::Accept && judgeGaps(balance, settings_, budget.exhausted(), world, trial)) {
            countRejection(world, Reason::GapEnergy);
            continue;
        }
        bool secondOrder = false;
        if (verdict == Verdict::Accept && !trial.stage.gaps.any())
            verdict = refine(part, world.time - start, port, budget, secondOrder);
        if (verdict == Verdict::Repeat)
            continue;
        if (verdict == Verdict::End)
            break;
        if (secondOrder)
            acceptSecondOrder(world, trial);
        else
            acceptStep(world, trial, times_);
        endShares(world, trial);
        budget.accept();
        breakOverloaded(world, out.broken);
        if (settings_.autoSleep)
            measureRest(world, settings_, trial.dt);
        work_->lastDt = trial.dt;
        const double growth = part.cuts > 0 ? 1.0 : budget.growth(trial.dt, world.dtNext);
        world.dtNext = nextSize(settings, trial, growth);
        if (secondOrder)
            world.dtNext = std::min(world.dtNext, nextSize(trial));
        part.cuts = part.unsolved = 0;
        SC_ASSERT(!(world.dtNext <= 0.0), "the next step takes time");
        left -= part.ticks;
        world.time = start + frame * static_cast<double>(kTicks - left) / kTicks;
        if (part.bodiesMeetOthers(frame - (world.time - start)))
            break;
        out.stopped = observer.afterStep(world);
        out.budgetExhausted = left > 0 && budget.exhausted();
    }
    out.work = budget.used();
    const double gained = gainedEnergy(balance, world);
    if (gained > 0.0 && gained > boundOfGain(balance, world, settings_, frame) + trial.stage.gaps.lawfulWork)
        out.gained = gained;
    for (Rod& r : world.rods) {
        r.dtNext = world.dtNext;
        r.cuts = out.budgetExhausted ? part.cuts : 0;
    }
    out.advanced = frame * static_cast<double>(kTicks - left) / kTicks;
    SC_ASSERT(!(out.advanced < 0.0) && !(out.advanced > frame + 1e-9 * (frame + std::abs(start))),
              "a frame advances by its length at most");
    return out;
}

/// All shells in one problem with steps of one size.
FrameResult Stepper::advanceWhole(World& world, double frame, Port* port, FrameObserver& observer) {
    const double start = world.time;
    Part part{world, work_->trial, work_->reading};
    part.budget = static_cast<double>(settings_.frameWork);
    FrameResult out = advancePart(part, frame, port, observer);
    out.advanced = world.time - start;
    endFrame(world, out.advanced, port, times_);
    return out;
}

FrameResult Stepper::advance(World& world, double frame, Port* port,
                             const std::function<bool(const World&)>& observer) {
    FunctionObserver adapted(observer);
    return advance(world, frame, port, adapted);
}

FrameResult Stepper::advance(World& world, double frame, Port* port, FrameObserver& observer) {
    FrameResult out;
    if (!(frame > 0.0) || !std::isfinite(frame)) {
        out.failure = "the frame must be a positive number of seconds";
        return out;
    }
    const bool whole = observer.wantsWholeWorld() || indivisible(world, settings_);
    const Vec2 crossheadVelocity = world.crossheadVelocity;
    endStops(world);
    if (crossheadStands(world))
        world.crossheadVelocity.setZero();
    beginFrame(world, settings_, frame, port, !whole, work_->reading, times_);
    const std::string refused = work_->reading.why;
    updateVetoes(world, frame, pairFilter);
    stopHolds(world, frame);
    if (whole) {
        out = advanceWhole(world, frame, port, observer);
    } else {
        makePartition(world, frame, {}, work_->partition);
        out = work_->partition.isOne(world) ? advanceAlone(world, frame, port, observer)
                                            : advanceIslands(world, frame, port, observer);
    }
    out.refused = refused;
    if (port && out.advanced > 0.0) {
        stopInHost(world, *port);
        port->foresee(out.advanced);
    }
    world.crossheadVelocity = crossheadVelocity;
    if (settings_.crush == CrushPolicy::Stop)
        stopBodies(world, out.crushed);
    removeBroken(world);
    if (port)
        out.carried = work_->reading.carried;
    endOfFrame(world);
    if (settings_.autoSleep)
        sleepAtRest(world, settings_, frame);
    return out;
}

} // namespace supercircle::step
