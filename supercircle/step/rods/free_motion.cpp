#include "supercircle/step/rods/free_motion.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/rods/free_equations.h"
#include "supercircle/step/rods/hold_rows.h"
#include "supercircle/step/rods/sdirk2.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr double kRememberEnergy = 0.9;                     ///< of vibration, a step: it is all bending at times
constexpr double kShorterToSolve = 16.0;                    ///< than the error asks for, where stages do not converge
constexpr double kLongestGrowth = 2.0, kShortestCut = 0.25; ///< of a step

/// Whether the moment depends on curvature and its rate alone, not on what was before.
bool isMemoryless(const effects::MaterialModel& m) {
    return m.branches.empty() && m.softening == 0.0 && std::isinf(m.yield);
}

/// Moves the state of the rod's effects over a step, in which their viscosity took `damped` J. Returns what they took.
double acceptMaterial(Rod& rod, double dt, double damped) {
    effects::RodEffects& fx = rod.effects;
    const double before = effects::taken(fx.energies);
    fx.material.age += dt;
    effects::storedEnergy(rod.model, fx.material, rod.q, fx.energies);
    fx.energies[static_cast<std::size_t>(effects::Key::ViscoelasticBending)].dissipated += damped;
    return effects::taken(fx.energies) - before;
}

/// One motion from the start of the step to its end.
class FreeMotion {
public:
    FreeMotion(const World& world, const Settings& settings, const Rod& rod, double dt, RodWork& w)
        : world_(world), settings_(settings), rod_(rod), w_(w), f_(w.free), dt_(dt),
          equations_(world, settings, rod, w) {}

    bool run();

private:
    [[nodiscard]] Eigen::Index x() const { return rod_.model.dofX(); }
    void begin();
    bool tryStep(double start, double size);
    [[nodiscard]] double errorOf(double tau);
    [[nodiscard]] double leastBending(double size) const;
    [[nodiscard]] double vibration(const Eigen::VectorXd& p, const Eigen::VectorXd& v) const;
    void measureWay();
    void finish();

    const World& world_;
    const Settings& settings_;
    const Rod& rod_;
    RodWork& w_;
    FreeWork& f_;
    double dt_;
    FreeEquations equations_;
};

/// State at the start, from the material velocities.
void FreeMotion::begin() {
    const rod::RodModel& model = rod_.model;
    f_.centre = rod::massCentre(rod_.kin, rod_.gauss);
    Vec2 drift = Vec2::Zero();
    for (std::size_t g = 0; g < rod_.u.size(); ++g)
        drift += (rod_.gauss.mass[g] / rod_.model.mass()) * rod_.u[g];
    f_.u = rod_.u;
    for (Vec2& u : f_.u)
        u -= drift;
    rod::momentum(model, rod_.kin, rod_.gauss, f_.u, f_.p);
    f_.q = rod_.q;
    f_.v = rod_.v;
    f_.q.segment<2>(x()) = f_.centre;
    f_.p.segment<2>(x()) = rod_.model.mass() * drift;
    f_.v.segment<2>(x()) = drift;
    f_.holdWork = f_.damped = 0.0;
    f_.least = rod::bendingEnergy(model, rod_.q);
    f_.vibration = rod_.vibration;
    f_.size = rod_.freeStep;
    f_.steps = f_.iterations = 0;
    f_.hasHolds = model.definition().closed || !rod_.holds.empty();
    w_.moved = w_.shift = w_.error = f_.about = 0.0;
    f_.closest = std::numeric_limits<double>::infinity();
    f_.carried.setZero();
    equations_.evaluate(f_.q, f_.v);
}

/// Energy of motion that is no rigid one, J.
double FreeMotion::vibration(const Eigen::VectorXd& p, const Eigen::VectorXd& v) const {
    const Eigen::Index T = rod_.model.dofTheta();
    double energy = 0.5 * (p.head(x()).dot(v.head(x())) + p[T] * v[T]);
    if (rod_.holds.empty() && w_.A(T, T) > 0.0)
        energy -= 0.5 * p[T] * p[T] / w_.A(T, T);
    return std::max(0.0, energy);
}

/// Squared error of the step just made, in units of what may be: above 1 it is too large.
double FreeMotion::errorOf(double tau) {
    const rod::RodModel& model = rod_.model;
    FreeStage &one = f_.stages[0], &two = f_.stages[1];
    f_.change = (two.p - two.p0) - (one.p - one.p0);
    f_.product = f_.change;
    w_.llt.solveInPlace(f_.change);
    if (f_.hasHolds) {
        f_.rates.setZero();
        equations_.constrain(f_.rates, f_.change);
    }
    double energy = 0.5 * std::max(0.0, f_.change.dot(f_.product)), way = 0.0;
    for (int i = 0; i < model.elements(); ++i) {
        const double bent = tau * (two.v[i] - one.v[i]);
        energy += 0.5 * rod::bendingStiffness(model, model.elementOfDof(i)) * bent * bent;
        way += std::abs(bent) * model.elementLength(model.elementOfDof(i));
    }
    f_.vibration = std::max({kRememberEnergy * f_.vibration, vibration(one.p, one.v), vibration(two.p, two.v)});
    const double byEnergy = energy / std::max(settings_.freeError * settings_.freeError * f_.vibration, 1e-300);
    const double least = settings_.freeLeast * model.definition().thickness;
    const double bySize = 0.5 * way * model.definition().length / least;
    return std::min(byEnergy, bySize * bySize);
}

/// Smallest bending energy on the way from the present state to the second stage, J: of the cubic through the energies
/// and their rates at both ends. Between two steps of a swing it may be far below both.
double FreeMotion::leastBending(double size) const {
    const rod::RodModel& model = rod_.model;
    const FreeStage& end = f_.stages[1];
    const double from = rod::bendingEnergy(model, f_.q), to = rod::bendingEnergy(model, end.q);
    double falls = 0.0, rises = 0.0; // rates times size
    for (int i = 0; i < model.elements(); ++i) {
        const int element = model.elementOfDof(i);
        const double k = size * rod::bendingStiffness(model, element);
        const double natural = model.definition().naturalCurvature[static_cast<std::size_t>(element)];
        falls += k * (f_.q[i] - natural) * f_.v[i];
        rises += k * (end.q[i] - natural) * end.v[i];
    }
    double least = std::min(from, to);
    if (falls < 0.0 && rises > 0.0)
        for (const double x : {0.2, 0.35, 0.5, 0.65, 0.8}) {
            const double y = 1.0 - x;
            least = std::min(least, y * y * (1.0 + 2.0 * x) * from + x * y * y * falls + x * x * (3.0 - 2.0 * x) * to -
                                        x * x * y * rises);
        }
    return std::max(0.0, least);
}

/// One step of `size` s from `start` s on, where the geometry was evaluated last, and at whose end it is. False: it
/// must be shorter.
bool FreeMotion::tryStep(double start, double size) {
    const rod::RodModel& model = rod_.model;
    const double tau = kGamma * size;
    equations_.factor(tau, f_.q);
    FreeStage &one = f_.stages[0], &two = f_.stages[1];
    one.q0 = f_.q;
    one.p0 = f_.p;
    one.v = f_.v;
    if (!equations_.solve(tau, start + tau, one))
        return false;
    two.q0 = f_.q + kExtrapolate * (one.q - f_.q);
    two.p0 = f_.p + kExtrapolate * (one.p - f_.p);
    two.v = f_.v + (one.v - f_.v) / kGamma;
    if (!equations_.solve(tau, start + size, two))
        return false;
    const double error = settings_.fixedDt > 0.0 ? 0.0 : errorOf(tau);
    const double wanted =
        size * std::clamp(0.9 / std::sqrt(std::sqrt(std::max(error, 1e-12))), kShortestCut, kLongestGrowth);
    f_.size = std::max(wanted, std::min(kLongestGrowth * size, dt_ / settings_.freeSteps));
    if (error > 1.0 && size > f_.size * (1.0 + 1e-6))
        return false;
    f_.least = std::min(f_.least, leastBending(size));
    f_.q = two.q;
    f_.p = two.p;
    f_.v = two.v;
    for (int i = 0; i < 2; ++i) {
        const FreeStage& s = f_.stages[static_cast<std::size_t>(i)];
        const double weight = i == 0 ? kExtrapolate : 1.0; // times tau
        if (!rod_.holds.empty()) {
            holdRates(world_, rod_, i == 0 ? start + tau : start + size, f_.rates);
            f_.holdWork += weight * s.impulse.dot(f_.rates);
        }
        for (int k = 0; k < model.elements(); ++k)
            f_.damped += weight * tau * equations_.viscosity() * rod::bendingStiffness(model, model.elementOfDof(k)) *
                         s.v[k] * s.v[k];
    }
    f_.tau = tau;
    equations_.evaluate(f_.q, f_.v);
    if (f_.hasHolds) {
        equations_.closeHolds(start + size, f_.q);
        equations_.evaluate(f_.q, f_.v);
    }
    ++f_.steps;
    return true;
}

void FreeMotion::measureWay() {
    const rod::RodModel& model = rod_.model;
    f_.carried = f_.q.segment<2>(x()) - f_.centre;
    for (int i = 0; i <= model.elements(); ++i) {
        const Vec2 way = w_.kin.node(i) + f_.middle - rod_.kin.node(i);
        w_.moved = std::max(w_.moved, way.norm());
        f_.about = std::max(f_.about, (way - f_.carried).norm());
    }
    for (const SelfPair& pair : f_.selfPairs) {
        const double now =
            (w_.kin.point(rod::locate(model, pair.s[0])) - w_.kin.point(rod::locate(model, pair.s[1]))).norm();
        f_.closest = std::min(f_.closest, pair.gap + now - pair.distance);
    }
}

/// What the other stages read of a rod.
void FreeMotion::finish() {
    const rod::RodModel& model = rod_.model;
    w_.qk = rod_.q;
    w_.q1 = f_.q;
    w_.q1.segment<2>(x()) = f_.middle;
    w_.v = f_.v;
    w_.v.segment<2>(x()) = f_.middleVelocity;
    w_.kin.evaluate(model, w_.q1);
    w_.kin1 = w_.kin;
    w_.u0 = rod_.u;
    w_.u1 = f_.u;
    const Vec2 drift = f_.v.segment<2>(x());
    for (Vec2& u : w_.u1)
        u += drift;
    w_.shift = w_.moved;
    w_.C.resize(0, model.dofs());
    w_.vFree = w_.v;
    w_.body = -1;
    w_.frozen = w_.touching = w_.loaded = false;
    w_.rollingCount = 0;
    w_.load.resize(0);
    w_.mouseJoints.clear();
    w_.impactShare = 0.0;
    w_.contactImpulse.setZero(model.dofs());
}

bool FreeMotion::run() {
    begin();
    const double least = dt_ / settings_.freeSteps;
    double done = 0.0;
    const double shortest = least / kShorterToSolve;
    const int most = static_cast<int>(2.0 * kShorterToSolve) * settings_.freeSteps;
    for (int tries = 0; done < dt_ * (1.0 - 1e-12); ++tries) {
        if (tries > most)
            return false;
        const double left = dt_ - done;
        double size = left;
        if (settings_.fixedDt <= 0.0 && f_.size > 0.0)
            size = left / std::max(1.0, std::ceil(left / std::max(f_.size, shortest) * (1.0 - 1e-9)));
        f_.size = 0.5 * size; // where it fails without an estimate
        if (!tryStep(done, size)) {
            if (settings_.fixedDt > 0.0 || size <= shortest * (1.0 + 1e-9))
                return false;
            equations_.evaluate(f_.q, f_.v);
            continue;
        }
        done = size == left ? dt_ : done + size;
        measureWay();
    }
    finish();
    return true;
}

} // namespace

bool mayMoveFreely(const Rod& rod) {
    const effects::RodEffects& fx = rod.effects;
    return !rod.frozen() && rod.mouseJoints.empty() && !fx.drag.on() && !fx.adhesion.model.on() &&
           (!fx.material.on() || isMemoryless(fx.material.model));
}

bool moveFreely(const World& world, const Settings& settings, const Rod& rod, double dt, RodWork& w) {
    SC_ASSERT(dt > 0.0 && settings.freeSteps > 0, "a step takes time");
    return FreeMotion(world, settings, rod, dt, w).run();
}

void standAside(const Rod& rod, RodWork& w) {
    freezeRod(rod, w);
    w.frozen = false;
    w.isFree = true;
}

RodEnergies acceptFreeMotion(const World& world, Rod& rod, double dt, RodWork& w) {
    RodEnergies energies;
    FreeWork& f = w.free;
    const Vec2 before = rod::massCentre(rod.kin, rod.gauss);
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
    energies.holdWork = f.holdWork;
    energies.damping = f.damped > 0.0 ? f.damped * (rod.dampingTime / viscosityOf(rod)) : 0.0;
    if (rod.effects.material.on())
        energies.effects = acceptMaterial(rod, dt, f.damped - energies.damping);
    // What the scheme took, in total: its parts have no sign of their own.
    energies.secondOrder = energies.holdWork + energies.loadWork - energies.damping - energies.effects -
                           (energies.kineticChange + energies.bendingChange + energies.gravityChange);
    const Eigen::VectorXd& impulse = f.stages[1].impulse;
    Eigen::Index row = 0;
    for (Hold& h : rod.holds) {
        h.reaction = impulse.segment<2>(row) / f.tau;
        row += 2;
        h.reactionTorque = h.clamped ? impulse[row++] / f.tau : 0.0;
        advanceTarget(world, dt, h);
    }
    rod.freeStep = f.size;
    rod.vibration = f.vibration;
    rod.speed = w.moved / dt;
    rod.leastBending = f.least;
    rod.lastAccepted = rod.q;
    return energies;
}

} // namespace supercircle::step
