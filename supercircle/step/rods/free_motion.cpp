#include "supercircle/step/rods/free_motion.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/rods/free_material.h"
#include "supercircle/step/rods/free_system.h"
#include "supercircle/step/rods/hold_rows.h"
#include "supercircle/step/rods/hold_springs.h"
#include "supercircle/step/rods/sdirk2.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr double kRememberEnergy = 0.9;  ///< of vibration, a step: it is all bending at times
constexpr double kShorterToSolve = 16.0; ///< than the error asks for, where stages do not converge
/// Error of the steps of joined and of pushed rods, of the amplitude, at most: they have no coordinates in which their
/// rigid motion is exact. Twice as much takes 3 % more of the energy of a fast triple pendulum of a game in ten swings;
/// half as much makes 40 % more such steps where errors choose them.
constexpr double kRigidError = 0.005;
/// Energy that a step of such rods may bring in, of Settings::freeError and what they move with. A strip that its
/// tether jerks round in a game swings between 0.5 % too much and too little without it, 0.1 % with it. Half of it
/// makes a quarter more steps of their own in fast turns, and none in slow ones; twice as much lets 60 % more in.
constexpr double kGain = 1e-3;
/// The same of rods that hang on holds alone, of what they move and bend with: a tenth of what raises the alarm on
/// energy (energy_gain.h). Twice as much lets a fast pendulum of a game raise it in frames of five such steps.
constexpr double kGainOfHeld = 1e-4;
constexpr double kLongestGrowth = 2.0, kShortestCut = 0.25; ///< of a step

/// One motion from the start of the step to its end, of rods that joints tie to each other or of one alone.
class FreeMotion {
public:
    FreeMotion(const World& world, const Settings& settings, const std::vector<BodyMotion>& motion,
               std::vector<RodWork>& rods, FreeGroup& group, double dt)
        : settings_(settings), world_(world), g_(group), dt_(dt), system_(world, settings, motion, rods, group) {}

    bool run();

private:
    [[nodiscard]] bool begin();
    void beginRod(const Rod& rod, FreeWork& f);
    bool tryStep(double start, double size);
    [[nodiscard]] double errorOf(double tau);
    [[nodiscard]] double vibration(std::size_t stage);
    [[nodiscard]] double holdWork(std::size_t i, double start, double size, double tau);
    [[nodiscard]] double mouseWork(std::size_t i, double tau);
    [[nodiscard]] bool gains(double start, double size, double tau, double energy);
    void takeRod(std::size_t i, double start, double size, double tau);
    void measureWay();
    void finish();

    const Settings& settings_;
    const World& world_;
    FreeGroup& g_;
    double dt_;
    FreeSystem system_;
    double least_ = 0.0;  ///< step of their own that errors may ask for, s
    double energy_ = 0.0; ///< of guarded rods and the bodies on them at the start of a step of their own, J
    /// Whether the rigid motion has errors too, as joints, forces at points or air act; whether energy may be brought
    /// in, as by those or by holds.
    bool inexact_ = false, guarded_ = false;
    bool yields_ = false; ///< a rod flows: the ordinary step has the flow rule
};

/// State at the start, from the material velocities.
void FreeMotion::beginRod(const Rod& rod, FreeWork& f) {
    const rod::RodModel& model = rod.model;
    const Eigen::Index x = model.dofX();
    f.centre = rod::massCentre(rod.kin, rod.gauss);
    Vec2 drift = Vec2::Zero();
    for (std::size_t g = 0; g < rod.u.size(); ++g)
        drift += (rod.gauss.mass[g] / model.mass()) * rod.u[g];
    f.u = rod.u;
    for (Vec2& u : f.u)
        u -= drift;
    rod::momentum(model, rod.kin, rod.gauss, f.u, f.p);
    f.q = rod.q;
    f.v = rod.v;
    f.q.segment<2>(x) = f.centre;
    f.p.segment<2>(x) = model.mass() * drift;
    f.v.segment<2>(x) = drift;
    f.holdWork = f.damped = f.airTaken = f.mouseWork = 0.0;
    beginMaterial(rod, f);
    f.least = rod::bendingEnergy(model, rod.q);
    f.closest = std::numeric_limits<double>::infinity();
    f.about = 0.0;
    f.carried.setZero();
}

bool FreeMotion::begin() {
    g_.steps = g_.iterations = 0;
    g_.vibration = 0.0;
    g_.size = std::numeric_limits<double>::infinity();
    inexact_ = !g_.joints.empty();
    for (std::size_t i = 0; i < system_.size(); ++i) {
        const Rod& rod = system_.rod(i);
        beginRod(rod, system_.free(i));
        RodWork& w = system_.work(i);
        w.moved = w.shift = w.error = 0.0;
        g_.vibration = std::max(g_.vibration, rod.vibration);
        g_.size = std::min(g_.size, rod.freeStep);
        inexact_ = inexact_ || !rod.forces.empty() || !rod.mouseJoints.empty() || rod.effects.air.on();
        guarded_ = guarded_ || inexact_ || !rod.holds.empty();
    }
    system_.evaluate();
    if (!system_.begin())
        return false;
    if (guarded_)
        energy_ = system_.energyAtStart();
    return true;
}

/// Whether a step of guarded rods brings in more energy than its error may: the scheme takes energy where it is linear,
/// not where a rod turns fast about a joint or by a force at its end.
/// @param energy at its end, J
bool FreeMotion::gains(double start, double size, double tau, double energy) {
    double given = 0.0;
    for (std::size_t i = 0; i < system_.size(); ++i)
        given += holdWork(i, start, size, tau) + mouseWork(i, tau);
    for (const FreeJoint& j : g_.joints)
        given += kExtrapolate * j.stages[0].given + j.stages[1].given;
    const double gained = energy - energy_ - given;
    double allowed = kGain * settings_.freeError * g_.vibration;
    if (!inexact_) // at rest, round-off is all that moves
        allowed = std::max(allowed, kGainOfHeld * (g_.vibration + system_.bendingAtEnd()));
    return gained > allowed;
}

/// Energy of motion that is no rigid one, J; of inexact rods, all that is not of their common centre of mass.
double FreeMotion::vibration(std::size_t stage) {
    double energy = 0.0, mass = 0.0;
    Vec2 momentum = Vec2::Zero();
    for (std::size_t i = 0; i < system_.size(); ++i) {
        const Rod& rod = system_.rod(i);
        const FreeStage& s = system_.free(i).stages[stage];
        const Eigen::MatrixXd& A = system_.work(i).A;
        const Eigen::Index x = rod.model.dofX(), T = rod.model.dofTheta();
        energy += 0.5 * (s.p.head(x).dot(s.v.head(x)) + s.p[T] * s.v[T]);
        if (!inexact_ && rod.holds.empty() && A(T, T) > 0.0)
            energy -= 0.5 * s.p[T] * s.p[T] / A(T, T);
        if (inexact_) {
            energy += 0.5 * s.p.segment<2>(x).dot(s.v.segment<2>(x));
            momentum += s.p.segment<2>(x);
            mass += rod.model.mass();
        }
    }
    for (const FreeBody& b : g_.bodies) {
        energy += 0.5 * b.stages[stage].p.dot(b.stages[stage].v);
        momentum += b.stages[stage].p.head<2>();
        mass += b.mass.x();
    }
    if (inexact_ && !g_.tied)
        energy -= 0.5 * momentum.squaredNorm() / mass;
    return std::max(0.0, energy);
}

/// Squared error of the step just made, in units of what may be: above 1 it is too large.
double FreeMotion::errorOf(double tau) {
    const auto change = [](const auto& stages) { return (stages[1].p - stages[1].p0) - (stages[0].p - stages[0].p0); };
    for (std::size_t i = 0; i < system_.size(); ++i) {
        FreeWork& f = system_.free(i);
        f.change = change(f.stages);
        f.product = f.change;
        system_.work(i).llt.solveInPlace(f.change);
    }
    for (FreeBody& b : g_.bodies)
        b.change = change(b.stages).cwiseQuotient(b.A);
    if (system_.hasRows())
        system_.constrainChange();
    double energy = 0.0, bySize = 0.0;
    for (std::size_t i = 0; i < system_.size(); ++i) {
        const rod::RodModel& model = system_.rod(i).model;
        FreeWork& f = system_.free(i);
        const FreeStage &one = f.stages[0], &two = f.stages[1];
        energy += 0.5 * std::max(0.0, f.change.dot(f.product));
        const auto bent = tau * (two.v - one.v);
        energy += 0.5 * rod::bendingForm(model, bent);
        double way = 0.0;
        for (int k = 0; k < model.elements(); ++k)
            way += std::abs(bent[k]) * model.elementLength(model.elementOfDof(k));
        if (inexact_) {
            const Eigen::Index T = model.dofTheta(), x = model.dofX();
            way += tau * (std::abs(two.v[T] - one.v[T]) +
                          2.0 * (two.v - one.v).segment<2>(x).norm() / model.definition().length);
        }
        const double least = settings_.freeLeast * model.definition().thickness;
        bySize = std::max(bySize, 0.5 * way * model.definition().length / least);
    }
    for (const FreeBody& b : g_.bodies)
        energy += 0.5 * b.change.dot(b.A.cwiseProduct(b.change));
    g_.vibration = std::max({kRememberEnergy * g_.vibration, vibration(0), vibration(1)});
    const double allowed = !inexact_ ? settings_.freeError : std::min(settings_.freeError, kRigidError);
    const double byEnergy = energy / std::max(allowed * allowed * g_.vibration, 1e-300);
    return std::min(byEnergy, bySize * bySize);
}

/// Smallest bending energy on the way from the present state to the second stage, J: of the cubic through the energies
/// and their rates at both ends. Between two steps of a swing it may be far below both.
double leastBending(const rod::RodModel& model, const FreeWork& f, double size) {
    const FreeStage& end = f.stages[1];
    const double from = rod::bendingEnergy(model, f.q), to = rod::bendingEnergy(model, end.q);
    const double falls = size * rod::bendingRate(model, f.q, f.v), rises = size * rod::bendingRate(model, end.q, end.v);
    double least = std::min(from, to);
    if (falls < 0.0 && rises > 0.0)
        for (const double x : {0.2, 0.35, 0.5, 0.65, 0.8}) {
            const double y = 1.0 - x;
            least = std::min(least, y * y * (1.0 + 2.0 * x) * from + x * y * y * falls + x * x * (3.0 - 2.0 * x) * to -
                                        x * x * y * rises);
        }
    return std::max(0.0, least);
}

/// Of the holds of one rod in the step of its own from `start` s on, J.
double FreeMotion::holdWork(std::size_t i, double start, double size, double tau) {
    const Rod& rod = system_.rod(i);
    FreeWork& f = system_.free(i);
    double work = 0.0;
    for (std::size_t stage = 0; stage < 2 && !rod.holds.empty(); ++stage) {
        holdRates(world_, rod, stage == 0 ? start + tau : start + size, f.rates);
        work += (stage == 0 ? kExtrapolate : 1.0) * f.stages[stage].impulse.head(f.held).dot(f.rates); // of tau
    }
    return work;
}

/// Of its mouse joints in a step of its own, J.
double FreeMotion::mouseWork(std::size_t i, double tau) {
    const auto& stages = system_.free(i).stages;
    return tau * (kExtrapolate * stages[0].mousePower + stages[1].mousePower);
}

/// What one rod took in the step of its own from `start` s on.
void FreeMotion::takeRod(std::size_t i, double start, double size, double tau) {
    const Rod& rod = system_.rod(i);
    const rod::RodModel& model = rod.model;
    FreeWork& f = system_.free(i);
    f.least = std::min(f.least, leastBending(model, f, size));
    const double viscosity = viscosityOf(rod);
    f.holdWork += holdWork(i, start, size, tau);
    f.mouseWork += mouseWork(i, tau);
    for (int stage = 0; stage < 2; ++stage) {
        const FreeStage& s = f.stages[static_cast<std::size_t>(stage)];
        const double weight = stage == 0 ? kExtrapolate : 1.0; // times tau
        if (viscosity > 0.0)
            f.damped += weight * tau * viscosity * rod::bendingForm(model, s.v);
        f.airTaken += weight * tau * s.airPower;
    }
    takeMaterial(rod, start, size, f);
}

/// One step of `size` s from `start` s on; the geometry is evaluated at its start, then at its end. False: too long.
bool FreeMotion::tryStep(double start, double size) {
    const double tau = kGamma * size;
    system_.factor(tau);
    system_.startStage(0);
    if (!system_.solve(0, tau, start + tau))
        return false;
    system_.startStage(1);
    if (!system_.solve(1, tau, start + size))
        return false;
    for (std::size_t i = 0; i < system_.size(); ++i)
        yields_ = yields_ || yields(system_.rod(i), system_.free(i), start + tau, start + size);
    if (yields_)
        return false;
    const double error = settings_.fixedDt > 0.0 ? 0.0 : errorOf(tau);
    const double wanted =
        size * std::clamp(0.9 / std::sqrt(std::sqrt(std::max(error, 1e-12))), kShortestCut, kLongestGrowth);
    g_.size = std::max(wanted, std::min(kLongestGrowth * size, dt_ / settings_.freeSteps));
    if (error > 1.0 && size > g_.size * (1.0 + 1e-6))
        return false;
    const double energy = guarded_ && settings_.fixedDt <= 0.0 ? system_.energyAtEnd(start + size) : 0.0;
    if (guarded_ && settings_.fixedDt <= 0.0 && size > least_ * (1.0 + 1e-9) && gains(start, size, tau, energy)) {
        g_.size = 0.5 * size;
        return false;
    }
    for (std::size_t i = 0; i < system_.size(); ++i)
        takeRod(i, start, size, tau);
    system_.take();
    g_.tau = tau;
    energy_ = energy;
    system_.evaluate();
    ++g_.steps;
    return true;
}

void FreeMotion::measureWay() {
    for (std::size_t k = 0; k < system_.size(); ++k) {
        const Rod& rod = system_.rod(k);
        RodWork& w = system_.work(k);
        FreeWork& f = w.free;
        f.carried = f.q.segment<2>(rod.model.dofX()) - f.centre;
        for (int i = 0; i <= rod.model.elements(); ++i) {
            const Vec2 way = w.kin.node(i) + f.middle - rod.kin.node(i);
            w.moved = std::max(w.moved, way.norm());
            f.about = std::max(f.about, (way - f.carried).norm());
        }
        for (const SelfPair& pair : f.selfPairs) {
            const double now =
                (w.kin.point(rod::locate(rod.model, pair.s[0])) - w.kin.point(rod::locate(rod.model, pair.s[1])))
                    .norm();
            f.closest = std::min(f.closest, pair.gap + now - pair.distance);
        }
    }
}

/// What the other stages read of the rods.
void FreeMotion::finish() {
    for (std::size_t i = 0; i < system_.size(); ++i) {
        const Rod& rod = system_.rod(i);
        const rod::RodModel& model = rod.model;
        const Eigen::Index x = model.dofX();
        RodWork& w = system_.work(i);
        FreeWork& f = w.free;
        f.tau = g_.tau;
        f.size = g_.size;
        f.vibration = g_.vibration;
        w.qk = rod.q;
        w.q1 = f.q;
        w.q1.segment<2>(x) = f.middle;
        w.v = f.v;
        w.v.segment<2>(x) = f.middleVelocity;
        w.kin.evaluate(model, w.q1);
        w.kin1 = w.kin;
        w.u0 = rod.u;
        w.u1 = f.u;
        const Vec2 drift = f.v.segment<2>(x);
        for (Vec2& u : w.u1)
            u += drift;
        w.shift = w.moved;
        w.C.resize(0, model.dofs());
        w.vFree = w.v;
        w.body = -1;
        w.frozen = w.touching = w.loaded = false;
        w.rollingCount = 0;
        w.load.resize(0);
        w.mouseJoints.clear();
        w.impactShare = 0.0;
        w.contactImpulse.setZero(model.dofs());
    }
}

bool FreeMotion::run() {
    if (!begin())
        return false;
    least_ = dt_ / settings_.freeSteps;
    double done = 0.0;
    // Joined rods have the ordinary step where a frame of a game would take too many of their own.
    const double shortest = inexact_ ? least_ : least_ / kShorterToSolve;
    const int most = static_cast<int>(2.0 * kShorterToSolve) * settings_.freeSteps;
    for (int tries = 0; done < dt_ * (1.0 - 1e-12); ++tries) {
        if (tries > most)
            return false;
        const double left = dt_ - done;
        double size = left;
        if (settings_.fixedDt <= 0.0 && g_.size > 0.0)
            size = left / std::max(1.0, std::ceil(left / std::max(g_.size, shortest) * (1.0 - 1e-9)));
        g_.size = 0.5 * size; // where it fails without an estimate
        if (!tryStep(done, size)) {
            if (yields_ || settings_.fixedDt > 0.0 || size <= shortest * (1.0 + 1e-9))
                return false;
            system_.evaluate();
            continue;
        }
        if (!system_.close(done + size))
            return false;
        done = size == left ? dt_ : done + size;
        measureWay();
    }
    finish();
    return true;
}

} // namespace

bool mayMoveFreely(const Rod& rod) {
    const effects::RodEffects& fx = rod.effects;
    return !rod.frozen() && !fx.drag.on() && !fx.adhesion.model.on();
}

bool moveFreely(const World& world, const Settings& settings, const std::vector<BodyMotion>& motion, double dt,
                std::vector<RodWork>& rods, FreeGroup& group) {
    SC_ASSERT(dt > 0.0 && settings.freeSteps > 0, "a step takes time");
    return FreeMotion(world, settings, motion, rods, group, dt).run();
}

void standAside(const Rod& rod, RodWork& w) {
    freezeRod(rod, w);
    w.frozen = false;
    w.isFree = true;
}

RodEnergies acceptFreeMotion(const World& world, Rod& rod, double dt, RodWork& w) {
    RodEnergies energies;
    FreeWork& f = w.free;
    energies.loadWork = f.mouseWork;
    const Vec2 before = rod::massCentre(rod.kin, rod.gauss);
    const double springs = holdSpringEnergy(world, rod, rod.kin, 0.0); // of the clamps, not of the rod
    energies.kineticChange = -rod::kineticEnergy(rod.gauss, rod.u);
    energies.bendingChange = rod::bendingEnergy(rod.model, w.q1) - rod::bendingEnergy(rod.model, rod.q);
    for (const AppliedForce& a : rod.forces) { // constant ones: their work is that of their way
        const rod::MaterialPoint at = rod::locate(rod.model, a.s);
        energies.loadWork +=
            a.force.dot(w.kin1.point(at) - rod.kin.point(at)) + a.torque * (w.kin1.angle(at) - rod.kin.angle(at));
    }
    rod.q = w.q1;
    rod.v = w.v;
    rod.u = w.u1;
    rod.kin = w.kin1;
    rod::evaluateGauss(rod.model, rod.kin, rod.gauss);
    energies.kineticChange += rod::kineticEnergy(rod.gauss, rod.u);
    energies.gravityChange = -rod.model.mass() * world.gravity.dot(rod::massCentre(rod.kin, rod.gauss) - before);
    energies.holdWork = f.holdWork + springs - holdSpringEnergy(world, rod, w.kin1, dt);
    energies.damping = f.damped > 0.0 ? f.damped * (rod.dampingTime / viscosityOf(rod)) : 0.0;
    if (rod.effects.material.on())
        energies.effects = acceptMaterial(rod, dt, f.damped - energies.damping, f);
    energies.effects += f.airTaken;
    rod.effects.energies[static_cast<std::size_t>(effects::Key::AirDrag)].dissipated += f.airTaken;
    // What the scheme took, in total: its parts have no sign of their own.
    energies.secondOrder = energies.holdWork + energies.loadWork - energies.damping - energies.effects -
                           (energies.kineticChange + energies.bendingChange + energies.gravityChange);
    recordMouseForces(rod, w);
    const Eigen::VectorXd& impulse = f.stages[1].impulse;
    Eigen::Index row = 0;
    for (Hold& h : rod.holds) {
        h.reaction = impulse.segment<2>(row) / f.tau;
        row += 2;
        h.reactionTorque = h.fixesAngle() ? impulse[row++] / f.tau : torqueOfHoldSpring(world, rod, h, w.kin1, dt);
        advanceTarget(world, dt, h);
    }
    rod.freeStep = f.size;
    rod.vibration = f.vibration;
    rod.speed = w.moved / dt;
    rod.leastBending = f.least;
    rod.lastAccepted = rod.q;
    return energies;
}

void acceptFreeJoints(World& world, double dt, const FreeGroup& group) {
    EnergyBalance& balance = world.energyBalance;
    for (const FreeJoint& j : group.joints) {
        Link& l = world.links[static_cast<std::size_t>(j.link)];
        l.force = j.impulse.head<2>() / dt;
        l.torque = j.impulse.z() / dt;
        balance.work += j.work;
        balance.toBodies += j.toBody;
        balance.addDrift(j.drift);
        balance.numerical += j.work + j.drift - j.toBody; // acceptFreeMotion() knows nothing of it
        if (j.body < 0)
            continue;
        Body& body = world.bodies[static_cast<std::size_t>(j.body)];
        body.force -= l.force;
        if (j.freeBody < 0)
            continue;
        body.impulse -= j.impulse.head<2>();
        body.angularImpulse -= j.turn;
    }
    for (const FreeBody& b : group.bodies) {
        Body& body = world.bodies[static_cast<std::size_t>(b.body)];
        HostCoupling& h = body.hostCoupling;
        const Eigen::Vector3d way = b.q - b.before - dt * b.drift;
        body.state.centre = b.q.head<2>();
        body.state.angle = b.q.z();
        body.state.velocity = b.v.head<2>();
        body.state.spin = b.v.z();
        h.hostImpulse += dt * body.state.mass * h.unexplained.expectedLinear;
        h.hostTurnImpulse += dt * body.state.inertia * h.unexplained.expectedAngular;
        h.travel += way.head<2>();
        h.turn += way.z();
        h.coupled = true;
        h.coupledTime += dt;
    }
}

} // namespace supercircle::step
