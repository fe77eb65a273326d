#include "supercircle/step/stepper.h"

#include "supercircle/step/budget.h"
#include "supercircle/step/loads.h"
#include "supercircle/step/sleep.h"
#include "supercircle/step/stages/stepper_work.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr std::int64_t kTicks = std::int64_t{1} << 24; ///< a frame is divided into powers of two of this
constexpr int kGiveUp = 40;                            ///< cuts in a row

/// Puts a rod back where it was last good, freezes it and takes it out of collision.
void quarantine(World& world, Rod& r) {
    r.quarantined = true;
    r.q = r.qGood;
    r.v.setZero();
    const double kinetic = rod::kineticEnergy(r.gauss, r.u);
    if (std::isfinite(kinetic)) { // its motion leaves the books as it leaves the world
        world.ledger.kinetic -= kinetic;
        world.ledger.added -= kinetic;
    }
    refreshRod(r);
    world.range.clear();
    ++world.counters.quarantined;
}

/// Rods with numbers that are not finite.
void check(World& world) {
    for (Rod& r : world.rods)
        if (!r.quarantined && !(r.q.allFinite() && r.v.allFinite()))
            quarantine(world, r);
}

/// Longest power-of-two part of the frame that is no longer than `want` seconds and than what is left.
std::int64_t ticksFor(double want, double frame, std::int64_t left) {
    std::int64_t ticks = kTicks;
    while (ticks > 1 && (ticks > left || static_cast<double>(ticks) / kTicks * frame > want * (1.0 + 1e-9)))
        ticks /= 2;
    return ticks;
}

/// Step size the controller wants after an accepted step.
double nextSize(const Settings& s, const Attempt& a, bool wasCut) {
    if (s.fixedDt > 0.0)
        return s.fixedDt;
    const double byError = 0.9 * std::sqrt(s.localError * a.h / std::max(a.error, 1e-300));
    const double byMotion = 0.75 * s.motionLimit * a.h / std::max(a.moved, 1e-300);
    return a.dt * std::clamp(std::min(byError, byMotion), 0.25, wasCut ? 1.0 : 2.0);
}

} // namespace

Stepper::Stepper(Settings settings) : settings_(settings), work_(std::make_unique<Work>()) {}
Stepper::~Stepper() = default;

const coulomb::Problem& Stepper::lastProblem() const {
    return work_->attempt.stage.problem;
}
const std::vector<contact::Candidate>& Stepper::lastCandidates() const {
    return work_->attempt.stage.candidates;
}
const Eigen::VectorXd& Stepper::lastImpulses() const {
    return work_->attempt.stage.r;
}
double Stepper::lastDt() const {
    return work_->lastDt;
}

/// Stages before the first step of a frame.
void Stepper::prepare(World& world, double frame, Port* port) {
    {
        StageTimer timer(times_, Stage::Check);
        check(world);
    }
    if (port) {
        StageTimer timer(times_, Stage::Pull);
        pullFromHost(world, *port, frame);
    }
    StageTimer timer(times_, Stage::Drive);
    for (Body& b : world.bodies) {
        b.impulse.setZero();
        b.angularImpulse = 0.0;
        if (b.driven)
            b.state.velocity = world.machineVelocity;
    }
    startPaths(world, frame);
    work_->attempt.h = settings_.length > 0.0 ? settings_.length : world.rods.empty() ? 1e-3 : thinnest(world);
    work_->attempt.useThreads(settings_.threads, loop);
    if (world.dtNext <= 0.0)
        world.dtNext = settings_.dtMax / 16.0;
}

/// Whether the attempt may become the next state; `cuts` in a row so far. An unconverged contact problem is tried at
/// half the size twice before it is taken as it is and counted.
bool Stepper::acceptable(Verdict verdict, int cuts) const {
    if (verdict == Verdict::Smaller)
        return false;
    return work_->attempt.stage.report.converged || settings_.acceptUnconverged || cuts >= 2 || settings_.fixedDt > 0.0;
}

FrameOutcome Stepper::advance(World& world, double frame, Port* port,
                              const std::function<bool(const World&)>& observer) {
    FrameOutcome out;
    if (!(frame > 0.0) || !std::isfinite(frame)) {
        out.failure = "the frame must be a positive number of seconds";
        return out;
    }
    prepare(world, frame, port);
    Attempt& attempt = work_->attempt;
    const double start = world.time;
    FrameBudget budget(settings_, world);
    int cuts = 0;
    for (std::int64_t left = kTicks; left > 0 && out.failure.empty() && !out.stopped && !out.late;) {
        const bool still = std::all_of(world.rods.begin(), world.rods.end(), [](const Rod& r) { return r.frozen(); });
        const double want = still                     ? frame
                            : settings_.fixedDt > 0.0 ? settings_.fixedDt * std::pow(0.5, cuts)
                                                      : std::clamp(world.dtNext, settings_.dtMin, settings_.dtMax);
        const std::int64_t ticks = ticksFor(want, frame, left);
        attempt.dt = frame * static_cast<double>(ticks) / kTicks;
        {
            StageTimer timer(times_, Stage::Collide);
            attempt.collidePresent(world, settings_);
        }
        const Settings& settings = budget.settings();
        const std::uint64_t solves = world.counters.solves;
        const Verdict verdict = attempt.solve(world, settings, times_, onSolve);
        budget.spend(world, attempt.contactsSolved, world.counters.solves - solves);
        if (verdict == Verdict::Woken)
            continue;
        const bool smallest = attempt.dt <= 2.0 * settings_.dtMin || ticks == 1 || cuts >= kGiveUp;
        if (!acceptable(verdict, cuts) && !smallest) {
            ++world.counters.rejected;
            ++cuts;
            world.dtNext = 0.5 * attempt.dt;
            continue;
        }
        if (!attempt.runaways.empty() && settings_.fixedDt <= 0.0) {
            // Shells put into each other are pushed apart faster than any force could, and every list of contacts
            // grows with their speed. The others go on without them.
            for (const std::size_t i : attempt.runaways)
                quarantine(world, world.rods[i]);
            cuts = 0;
            continue;
        }
        if (!attempt.rejectedBeforeEnd && !attempt.crossings.empty() && settings_.fixedDt <= 0.0) {
            // Something stands in the shell already (a body was put there): no step is short enough. A game goes on
            // without the shell until it is put elsewhere.
            world.counters.crossings += attempt.crossings.size();
            for (const contact::Crossing& c : attempt.crossings)
                if (Rod& r = world.rods[static_cast<std::size_t>(c.rodA)]; !r.quarantined)
                    quarantine(world, r);
            cuts = 0;
            continue;
        }
        const bool finite = std::all_of(attempt.rods.begin(), attempt.rods.end(),
                                        [](const RodWork& w) { return w.v.allFinite() && w.q1.allFinite(); });
        if (!finite || attempt.rejectedBeforeEnd || !attempt.crossings.empty()) {
            world.counters.crossings += attempt.crossings.size();
            out.failure = !finite                     ? "the contact solver returned numbers that are not finite"
                          : attempt.rejectedBeforeEnd ? "the step size fell to its minimum without an acceptable step"
                                                      : "shells would cross even at the smallest step";
            break;
        }
        {
            StageTimer timer(times_, Stage::Advance);
            accept(world, attempt);
        }
        if (settings_.autoSleep)
            measureRest(world, settings_, attempt.h, attempt.dt);
        work_->lastDt = attempt.dt;
        world.dtNext = nextSize(settings, attempt, cuts > 0);
        cuts = 0;
        left -= ticks;
        world.time = start + frame * static_cast<double>(kTicks - left) / kTicks;
        out.stopped = observer && observer(world);
        out.late = left > 0 && budget.usedUp();
    }
    out.advanced = world.time - start;
    endOfFrame(world);
    if (settings_.autoSleep)
        sleepAtRest(world, settings_);
    if (port) {
        StageTimer timer(times_, Stage::Push);
        pushToHost(world, *port, out.advanced);
    }
    return out;
}

} // namespace supercircle::step
