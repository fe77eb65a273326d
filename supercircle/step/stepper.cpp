#include "supercircle/step/stepper.h"

#include "supercircle/step/contact_stage.h"
#include "supercircle/step/parallel.h"
#include "supercircle/step/rod_stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace supercircle::step {

namespace {

class Timer {
public:
    Timer(StageTimes& times, Stage stage) : times_(times), stage_(stage), start_(std::chrono::steady_clock::now()) {}
    ~Timer() {
        times_[static_cast<std::size_t>(stage_)] +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

private:
    StageTimes& times_;
    Stage stage_;
    std::chrono::steady_clock::time_point start_;
};

constexpr std::int64_t kTicks = std::int64_t{1} << 24; ///< a frame is divided into powers of two of this

double thinnest(const World& world) {
    double h = std::numeric_limits<double>::infinity();
    for (const Rod& r : world.rods)
        h = std::min(h, r.model.definition().thickness);
    return std::isfinite(h) ? h : 1e-3;
}

double deepest(const std::vector<contact::Candidate>& list) {
    double depth = 0.0;
    for (const contact::Candidate& c : list)
        depth = std::max(depth, -c.gap);
    return depth;
}

} // namespace

enum class Verdict : std::uint8_t { Accept, Smaller, Failed };

struct Stepper::Work {
    std::vector<RodWork> rods;
    ContactStage stage;
    std::vector<const rod::Kinematics*> kin;
    std::vector<double> nextRange;
    std::vector<ContactImpulse> warm;
    std::vector<contact::Curve> curvesBefore;
    std::vector<contact::Outline> outlinesBefore;
    double h = 1e-3;
    double error = 0.0; ///< of the attempt, m
    double moved = 0.0; ///< of touching rods in the attempt, m
    bool hardSolve = false;
    double lastDt = 0.0;
};

Stepper::Stepper(Settings settings) : settings_(settings), work_(std::make_unique<Work>()) {}
Stepper::~Stepper() = default;

const coulomb::Problem& Stepper::lastProblem() const { return work_->stage.problem; }
const std::vector<contact::Candidate>& Stepper::lastCandidates() const { return work_->stage.candidates; }
const Eigen::VectorXd& Stepper::lastImpulses() const { return work_->stage.r; }
double Stepper::lastDt() const { return work_->lastDt; }

/// One attempt at a step of fixed size; the stages in order.
struct Attempt {
    Stepper& stepper;
    Settings& settings;
    World& world;
    std::vector<RodWork>& rods;
    ContactStage& stage;
    StageTimes& times;
    double dt;
    double h;
};

namespace {

bool check(World& world) {
    for (Rod& r : world.rods)
        if (!r.quarantined && !(r.q.allFinite() && r.v.allFinite())) {
            r.quarantined = true;
            return false;
        }
    return true;
}

/// Finds candidates at the present configuration if the known ones do not reach far enough for a step of `dt`.
void collidePresent(World& world, const Settings& s, ContactStage& stage, std::vector<const rod::Kinematics*>& kin,
                    double dt, double h) {
    const double fall = world.gravity.norm() * dt * dt;
    bool known = world.range.size() == world.rods.size();
    for (std::size_t i = 0; known && i < world.rods.size(); ++i)
        known = world.range[i] >= 0.9 * world.rods[i].speed * dt;
    if (known)
        return;
    world.range.resize(world.rods.size());
    kin.resize(world.rods.size());
    for (std::size_t i = 0; i < world.rods.size(); ++i) {
        world.range[i] = 1.5 * world.rods[i].speed * dt + 2.0 * fall;
        kin[i] = &world.rods[i].kin;
    }
    collide(world, kin, world.range, 0.0, 2.0 * dt, s.margin * h, stage, world.candidates);
}

struct GapErrors {
    double loaded = 0.0;  ///< largest |gap| of a loaded contact after the step, m
    double deepest = 0.0; ///< deepest overlap after the step, m
};

GapErrors gapErrors(const ContactStage& stage, const std::vector<ContactImpulse>& loaded) {
    GapErrors e;
    e.deepest = deepest(stage.after);
    for (const contact::Candidate& c : stage.after) {
        const auto it = std::lower_bound(loaded.begin(), loaded.end(), c.id,
                                         [](const ContactImpulse& a, std::uint64_t id) { return a.id < id; });
        if (it != loaded.end() && it->id == c.id)
            e.loaded = std::max(e.loaded, std::abs(c.gap));
    }
    return e;
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

/// Contact terms of the energy books and the forces on bodies; uses the rods' old velocities, so before acceptRods.
void bookContacts(World& world, std::vector<RodWork>& rods, ContactStage& stage, double dt) {
    for (Body& b : world.bodies)
        b.force.setZero();
    for (std::size_t i = 0; i < rods.size(); ++i) {
        rods[i].impactShare = 0.0;
        rods[i].push.setZero(world.rods[i].model.dofs());
    }
    for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
        const Vec2 r = stage.r.segment<2>(static_cast<Eigen::Index>(2 * i));
        if (r.isZero(0.0))
            continue;
        const contact::Candidate& c = stage.candidates[i];
        const ContactWork& k = stage.work[i];
        RodWork& a = rods[static_cast<std::size_t>(k.rodA)];
        Vec2 u = k.Ja * a.v - k.surface;
        a.push += k.Ja.transpose() * r;
        a.impactShare += 0.5 * r.dot(k.Ja * (a.v - world.rods[static_cast<std::size_t>(k.rodA)].v) );
        const Vec2 force = (c.normal * r.x() + rod::perp(c.normal) * r.y()) / dt;
        if (k.rodB >= 0) {
            RodWork& b = rods[static_cast<std::size_t>(k.rodB)];
            u -= k.Jb * b.v;
            b.push -= k.Jb.transpose() * r;
            b.impactShare -= 0.5 * r.dot(k.Jb * (b.v - world.rods[static_cast<std::size_t>(k.rodB)].v));
        } else {
            Body& body = world.bodies[static_cast<std::size_t>(k.bodyB)];
            body.force -= force;
            const int index = stage.bodyProblemIndex[static_cast<std::size_t>(k.bodyB)];
            if (index >= 0) {
                const Vec2 ub = stage.problem.contacts[i].Hb * stage.velocity[static_cast<std::size_t>(index)];
                u += ub;
                world.ledger.toBodies += r.dot(ub);
                body.impulse -= force * dt;
                body.angularImpulse -= rod::cross(k.armB, force * dt);
            } else {
                world.ledger.work += r.dot(k.surface);
            }
        }
        world.ledger.friction -= r.y() * u.y();
        world.ledger.pushOut -= r.x() * u.x();
    }
}

void advanceBodies(World& world, const ContactStage& stage, double dt) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
        Body& b = world.bodies[i];
        const int index = stage.bodyProblemIndex.size() == world.bodies.size() ? stage.bodyProblemIndex[i] : -1;
        if (index >= 0) {
            const Eigen::VectorXd& v = stage.velocity[static_cast<std::size_t>(index)];
            b.state.velocity = v.head<2>();
            b.state.spin = v[2];
        } else if (b.dynamic) {
            b.state.velocity += dt * (b.state.gravityScale * world.gravity + b.feedForward);
            b.state.spin += dt * b.feedForwardSpin;
        }
        b.state.centre += dt * b.state.velocity;
        b.state.angle += dt * b.state.spin;
    }
    world.machineTravel += dt * world.machineVelocity;
}

} // namespace

namespace {

/// First linearisation of an attempt: in the predicted middle of the step. Rods about to hit something are stepped fully
/// implicitly (theta = 1), which makes the impact perfectly plastic.
void begin(Attempt& t, double h) {
    World& world = t.world;
    const auto n = static_cast<int>(world.rods.size());
    std::vector<char> near(world.rods.size(), 0);
    for (const contact::Candidate& c : world.candidates) {
        near[static_cast<std::size_t>(c.a.rod)] = 1;
        if (c.b.rod >= 0)
            near[static_cast<std::size_t>(c.b.rod)] = 1;
    }
    parallelFor(n, t.settings.threads, [&](std::size_t i) {
        beginAtPredictedMiddle(world.rods[i], t.dt, near[i] ? 0.25 * h : std::numeric_limits<double>::infinity(),
                               t.rods[i]);
        t.rods[i].theta = t.settings.theta;
    });
    frameInMiddle(world, t.rods, world.candidates, false, t.dt, t.stage);
    for (std::size_t i = 0; i < t.stage.candidates.size(); ++i) {
        const contact::Candidate& c = t.stage.candidates[i];
        const double atEnd = 2.0 * c.gap - t.stage.gapAtStart[i]; // as the present velocities would have it
        if (atEnd < -t.settings.impactDepth * h && atEnd < t.stage.gapAtStart[i]) {
            t.rods[static_cast<std::size_t>(c.a.rod)].theta = 1.0;
            if (c.b.rod >= 0)
                t.rods[static_cast<std::size_t>(c.b.rod)].theta = 1.0;
        }
    }
}

/// Solves one linearisation after another until the gaps hold; leaves the result in rods and stage.
Verdict attempt(Attempt& t, std::vector<const rod::Kinematics*>& kin, std::vector<double>& nextRange,
                std::vector<ContactImpulse>& warm, double& error, double& movedMost,
                const std::function<void(const coulomb::Problem&, const coulomb::SolveReport&)>& onSolve) {
    World& world = t.world;
    const Settings& s = t.settings;
    const double h = t.h, dt = t.dt;
    const bool free = s.fixedDt <= 0.0;
    const double before = deepest(world.candidates);
    const double fall = world.gravity.norm() * dt * dt;
    const auto n = static_cast<int>(world.rods.size());
        warm = world.impulses;
    int widened = 0;
    begin(t, h);
    for (int iteration = 0;;) {
        {
            Timer timer(t.times, Stage::Evaluate);
            collectRolling(world, t.rods, dt, warm, iteration == 0, t.stage);
            parallelFor(n, s.threads, [&](std::size_t i) { evaluateRod(world, world.rods[i], dt, t.rods[i]); });
        }
        {
            Timer timer(t.times, Stage::Predict);
            parallelFor(n, s.threads, [&](std::size_t i) { predictRod(world.rods[i], t.rods[i]); });
        }
        {
            Timer timer(t.times, Stage::Couple);
            couple(world, t.rods, dt, warm, t.stage);
        }
        {
            Timer timer(t.times, Stage::Solve);
            solveContacts(world, t.rods, s.contact, t.stage);
            ++world.counters.solves;
            world.counters.sweeps += static_cast<std::uint64_t>(t.stage.report.sweeps);
            world.counters.pivots += static_cast<std::uint64_t>(t.stage.report.pivots);
            if (onSolve && !t.stage.candidates.empty())
                onSolve(t.stage.problem, t.stage.report);
        }
        Timer timer(t.times, Stage::Collide);
        for (const RodWork& w : t.rods)
            if (!w.v.allFinite())
                return Verdict::Smaller;
        parallelFor(n, s.threads, [&](std::size_t i) { advanceRod(world.rods[i], dt, t.rods[i]); });
        markTouching(t.rods, t.stage);
        error = movedMost = 0.0;
        bool outOfRange = false;
        for (int i = 0; i < n; ++i) {
            const RodWork& w = t.rods[static_cast<std::size_t>(i)];
            error = std::max(error, w.error);
            if (w.touching)
                movedMost = std::max(movedMost, w.moved);
            if (w.shift > world.range[static_cast<std::size_t>(i)] + 0.4 * s.margin * h) {
                outOfRange = true;
                world.range[static_cast<std::size_t>(i)] = 1.5 * w.shift;
            }
        }
        if (free && (movedMost > s.motionLimit * h || error > 2.0 * s.localError * h))
            return Verdict::Smaller;
        if (outOfRange && iteration == 0 && widened < 4) { // moved farther than the candidates reach: look farther
            ++widened;
            kin.resize(world.rods.size());
            for (int i = 0; i < n; ++i)
                kin[static_cast<std::size_t>(i)] = &world.rods[static_cast<std::size_t>(i)].kin;
            collide(world, kin, world.range, 0.0, 2.0 * dt, s.margin * h, t.stage, world.candidates);
            begin(t, h);
            continue;
        }
        if (outOfRange && widened >= 4)
            return Verdict::Smaller;
        kin.resize(world.rods.size());
        nextRange.resize(world.rods.size());
        for (int i = 0; i < n; ++i) {
            kin[static_cast<std::size_t>(i)] = &t.rods[static_cast<std::size_t>(i)].kin1;
            const RodWork& w = t.rods[static_cast<std::size_t>(i)]; // the next step is at most twice as long
            nextRange[static_cast<std::size_t>(i)] = 2.0 * w.moved + (w.touching ? 0.0 : 4.0 * fall);
        }
        collide(world, kin, nextRange, dt, 4.0 * dt, s.margin * h, t.stage, t.stage.after);
        gather(t.stage, dt, warm);
        const GapErrors e = gapErrors(t.stage, warm);
        const bool deeper = e.deepest > s.rejectPenetration * h && e.deepest > before + 0.1 * s.rejectPenetration * h;
        const bool off = e.loaded > s.relinearise * h || (e.deepest > s.relinearise * h && e.deepest > before);
        if (!deeper && !off)
            return Verdict::Accept;
        if (++iteration >= s.maxIterations) {
            if (deeper && (free || e.deepest > 0.25 * h))
                return Verdict::Smaller;
            return Verdict::Accept;
        }
        // once more, in the middle of the attempt
        parallelFor(n, s.threads, [&](std::size_t i) { relineariseInMiddle(world.rods[i], t.rods[i]); });
        frameInMiddle(world, t.rods, world.candidates, true, dt, t.stage);
        for (int i = 0; i < n; ++i)
            world.range[static_cast<std::size_t>(i)] = std::max(world.range[static_cast<std::size_t>(i)],
                                                                nextRange[static_cast<std::size_t>(i)]);
    }
}

/// Makes the attempt the world's new state and books its energies.
void accept(World& world, std::vector<RodWork>& rods, ContactStage& stage, double dt, double tolerance,
            const std::vector<double>& nextRange, const std::vector<ContactImpulse>& impulses) {
    bookContacts(world, rods, stage, dt);
    Ledger& l = world.ledger;
    for (std::size_t i = 0; i < rods.size(); ++i) {
        if (world.rods[i].quarantined)
            continue;
        const RodBooks b = acceptRod(world, world.rods[i], dt, rods[i]);
        const double impact = std::clamp(rods[i].impactShare, 0.0, b.kineticLoss);
        l.kinetic += b.kineticChange;
        l.bending += b.bendingChange;
        l.gravity += b.gravityChange;
        l.impact += impact;
        l.numerical += b.kineticLoss - impact + b.secondOrder;
        l.work += b.holdWork;
        l.pushOut -= b.rollingWork;
    }
    advanceBodies(world, stage, dt);
    world.impulses = impulses;
    world.candidates = stage.after;
    world.range = nextRange;
    world.dt = dt;
    ++world.counters.steps;
    world.counters.etaMax = std::max(world.counters.etaMax, stage.report.eta);
    if (!stage.report.converged && stage.report.eta > tolerance)
        ++world.counters.unconverged;
    world.counters.penetrationMax = std::max(world.counters.penetrationMax, deepest(world.candidates));
}

} // namespace

FrameOutcome Stepper::advance(World& world, double frame, Port* port,
                              const std::function<bool(const World&)>& observer) {
    FrameOutcome out;
    if (!(frame > 0.0) || !std::isfinite(frame)) {
        out.failure = "the frame must be a positive number of seconds";
        return out;
    }
    Work& w = *work_;
    {
        Timer timer(times_, Stage::Check);
        check(world);
    }
    if (port) {
        Timer timer(times_, Stage::Pull);
        pullFromHost(world, *port, frame);
    }
    {
        Timer timer(times_, Stage::Drive);
        for (Body& b : world.bodies) {
            b.impulse.setZero();
            b.angularImpulse = 0.0;
            if (b.driven)
                b.state.velocity = world.machineVelocity;
        }
    }
    w.rods.resize(world.rods.size());
    w.h = thinnest(world);
    if (world.dtNext <= 0.0)
        world.dtNext = settings_.dtMax / 16.0;
    const double start = world.time;
    std::int64_t left = kTicks;
    int failures = 0;
    while (left > 0) {
        const double want = settings_.fixedDt > 0.0 ? std::min(settings_.fixedDt, frame) * std::pow(0.5, failures)
                                                    : std::clamp(world.dtNext, settings_.dtMin, settings_.dtMax);
        std::int64_t ticks = kTicks;
        while (ticks > 1 && (ticks > left || static_cast<double>(ticks) / kTicks * frame > want * (1.0 + 1e-9)))
            ticks /= 2;
        const double dt = frame * static_cast<double>(ticks) / kTicks;
        {
            Timer timer(times_, Stage::Collide);
            collidePresent(world, settings_, w.stage, w.kin, dt, w.h);
        }
        if (settings_.witness) {
            placeOutlines(world, 0.0, 0.0, w.outlinesBefore);
            w.curvesBefore.resize(world.rods.size());
            for (std::size_t i = 0; i < world.rods.size(); ++i)
                toCurve(world.rods[i], world.rods[i].kin, w.curvesBefore[i]);
        }
        Attempt t{*this, settings_, world, w.rods, w.stage, times_, dt, w.h};
        const Verdict verdict = attempt(t, w.kin, w.nextRange, w.warm, w.error, w.moved, onSolve);
        const bool small = dt <= 2.0 * settings_.dtMin || ticks == 1;
        if (verdict != Verdict::Accept || (!w.stage.report.converged && failures < 2 && settings_.fixedDt <= 0.0)) {
            if (!small) {
                ++world.counters.rejected;
                ++failures;
                world.dtNext = 0.5 * dt;
                continue;
            }
            if (verdict != Verdict::Accept && failures > 40) {
                out.failure = "the step size fell below its minimum without an acceptable step";
                break;
            }
        }
        for (const RodWork& r : w.rods)
            if (!r.v.allFinite()) {
                out.failure = "the solver returned numbers that are not finite";
                world.time = start + frame * static_cast<double>(kTicks - left) / kTicks;
                out.advanced = world.time - start;
                return out;
            }
        Timer timer(times_, Stage::Advance);
        w.lastDt = dt;
        accept(world, w.rods, w.stage, dt, settings_.contact.tolerance, w.nextRange, w.warm);
        if (settings_.witness) {
            std::vector<contact::Crossing> found;
            std::vector<contact::Outline> after;
            placeOutlines(world, 0.0, 0.0, after);
            contact::findCrossingsSwept(w.curvesBefore, w.stage.curves, w.outlinesBefore, after, found);
            world.counters.crossings += found.size();
        }
        left -= ticks;
        world.time = start + frame * static_cast<double>(kTicks - left) / kTicks;
        const double byError = 0.9 * std::sqrt(settings_.localError * w.h / std::max(w.error, 1e-300));
        const double byMotion = 0.75 * settings_.motionLimit * w.h / std::max(w.moved, 1e-300);
        const double growth = failures > 0 ? 1.0 : 2.0;
        world.dtNext = dt * std::clamp(std::min(byError, byMotion), 0.25, growth);
        if (settings_.fixedDt > 0.0)
            world.dtNext = settings_.fixedDt;
        failures = 0;
        if (observer && observer(world)) {
            out.stopped = true;
            break;
        }
    }
    out.advanced = world.time - start;
    if (port) {
        Timer timer(times_, Stage::Push);
        pushToHost(world, *port, out.advanced);
    }
    return out;
}

} // namespace supercircle::step
