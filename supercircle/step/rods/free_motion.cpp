#include "supercircle/step/rods/free_motion.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr double kGamma = 0.29289321881345247560;           ///< 1 - 1/sqrt(2)
constexpr double kExtrapolate = (1.0 - kGamma) / kGamma;    ///< from the first stage to the start of the second
constexpr int kMostIterations = 16;                         ///< of a stage; twice as many seldom save a step
constexpr double kRememberEnergy = 0.9;                     ///< of vibration, a step: it is all bending at times
constexpr double kShorterToSolve = 16.0;                    ///< than the error asks for, where stages do not converge
constexpr double kLongestGrowth = 2.0, kShortestCut = 0.25; ///< of a step

/// Whether the moment depends on curvature and its rate alone, not on what was before.
bool isMemoryless(const effects::MaterialModel& m) {
    return m.branches.empty() && m.softening == 0.0 && std::isinf(m.yield);
}

double viscosityOf(const Rod& rod) {
    return rod.dampingTime + (rod.effects.material.on() ? rod.effects.material.model.viscosity : 0.0);
}

/// Moves the state of the rod's effects over a step, in which their viscosity took `damped` J. Returns what they took.
double acceptMaterial(Rod& rod, double dt, double damped) {
    effects::RodEffects& fx = rod.effects;
    const auto total = [&] {
        double sum = 0.0;
        for (const effects::EffectEnergy& e : fx.energies)
            sum += e.stored + e.dissipated;
        return sum;
    };
    const double before = total();
    fx.material.age += dt;
    effects::storedEnergy(rod.model, fx.material, rod.q, fx.energies);
    fx.energies[static_cast<std::size_t>(effects::Key::ViscoelasticBending)].dissipated += damped;
    return total() - before;
}

/// One motion from the start of the step to its end. All of q, p, v have the centre of mass in place of the middle.
class FreeMotion {
public:
    FreeMotion(const World& world, const Settings& settings, const Rod& rod, double dt, RodWork& w)
        : world_(world), settings_(settings), rod_(rod), w_(w), f_(w.free), dt_(dt), n_(rod.model.dofs()),
          viscosity_(viscosityOf(rod)) {}

    bool run();

private:
    [[nodiscard]] Eigen::Index x() const { return rod_.model.dofX(); }
    [[nodiscard]] double mass() const { return rod_.model.mass(); }
    void begin();
    void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
    void factor(double tau);
    [[nodiscard]] double tangentOf(int element, double curvature) const;
    void addBending(const FreeStage& s);
    void meanRows();
    void addForces();
    void holdRows();
    void holdRates(double ahead);
    void solveSchur();
    void constrain(const Eigen::VectorXd& rates, Eigen::VectorXd& change);
    bool stage(double tau, double ahead, FreeStage& s);
    bool tryStep(double start, double size);
    [[nodiscard]] double errorOf(double tau);
    [[nodiscard]] double leastBending(double size) const;
    void closeHolds(double ahead);
    [[nodiscard]] double vibration(const Eigen::VectorXd& p, const Eigen::VectorXd& v) const;
    void measureWay();
    void finish();

    const World& world_;
    const Settings& settings_;
    const Rod& rod_;
    RodWork& w_;
    FreeWork& f_;
    double dt_;
    Eigen::Index n_;
    double viscosity_; ///< of all damping, over B, s
};

/// State at the start, from the material velocities.
void FreeMotion::begin() {
    const rod::RodModel& model = rod_.model;
    f_.centre = rod::massCentre(rod_.kin, rod_.gauss);
    Vec2 drift = Vec2::Zero();
    for (std::size_t g = 0; g < rod_.u.size(); ++g)
        drift += (rod_.gauss.mass[g] / mass()) * rod_.u[g];
    f_.u = rod_.u;
    for (Vec2& u : f_.u)
        u -= drift;
    rod::momentum(model, rod_.kin, rod_.gauss, f_.u, f_.p);
    f_.q = rod_.q;
    f_.v = rod_.v;
    f_.q.segment<2>(x()) = f_.centre;
    f_.p.segment<2>(x()) = mass() * drift;
    f_.v.segment<2>(x()) = drift;
    w_.kin = rod_.kin;
    w_.gauss = rod_.gauss;
    f_.holdWork = f_.damped = 0.0;
    f_.least = rod::bendingEnergy(model, rod_.q);
    f_.vibration = rod_.vibration;
    f_.size = rod_.freeStep;
    f_.steps = f_.iterations = 0;
    f_.hasHolds = model.definition().closed || !rod_.holds.empty();
    w_.moved = w_.shift = w_.error = f_.about = 0.0;
    f_.closest = std::numeric_limits<double>::infinity();
    f_.carried.setZero();
}

/// Geometry at q, and the velocities about the centre of mass that v makes there.
void FreeMotion::evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
    const rod::RodModel& model = rod_.model;
    f_.shape = q;
    f_.shape.segment<2>(x()).setZero();
    w_.kin.evaluate(model, f_.shape);
    rod::evaluateGauss(model, w_.kin, w_.gauss);
    f_.middle = q.segment<2>(x()) - rod::massCentre(w_.kin, w_.gauss);
    f_.rate = v;
    f_.rate.segment<2>(x()).setZero();
    rod::velocityField(model, w_.kin, w_.gauss, f_.rate, f_.u);
    Vec2 mean = Vec2::Zero();
    for (std::size_t g = 0; g < f_.u.size(); ++g)
        mean += (w_.gauss.mass[g] / mass()) * f_.u[g];
    for (Vec2& u : f_.u)
        u -= mean;
    f_.middleVelocity = v.segment<2>(x()) - mean;
}

/// A = M + tau^2 K + tau D, at the geometry evaluated last. Motion about the centre of mass takes the mean out of J.
void FreeMotion::factor(double tau) {
    const rod::RodModel& model = rod_.model;
    rod::massMatrix(model, w_.kin, w_.gauss, w_.A);
    const Eigen::Index X = x(), Y = X + 1, T = model.dofTheta();
    const double perMass = 1.0 / mass();
    for (Eigen::Index j = 0; j < n_; ++j) {
        if (j == X || j == Y)
            continue;
        const double jx = perMass * w_.A(X, j), jy = perMass * w_.A(Y, j);
        for (Eigen::Index i = 0; i < n_; ++i)
            if (i < X || i == T)
                w_.A(i, j) -= w_.A(i, X) * jx + w_.A(i, Y) * jy;
    }
    for (Eigen::Index i = 0; i < n_; ++i)
        if (i < X || i == T)
            w_.A(X, i) = w_.A(i, X) = w_.A(Y, i) = w_.A(i, Y) = 0.0;
    for (int i = 0; i < model.elements(); ++i) {
        const int element = model.elementOfDof(i);
        w_.A(i, i) += tau * (tau * tangentOf(element, f_.q[i]) + viscosity_ * rod::bendingStiffness(model, element));
    }
    w_.llt.compute(w_.A);
}

/// Slope of the elastic moment of an element times its length, N m^3.
double FreeMotion::tangentOf(int element, double curvature) const {
    if (!rod_.effects.material.on())
        return rod::bendingStiffness(rod_.model, element);
    constexpr double kUnit = 1.0; // s: of a step without change, whose viscous part is known
    const effects::Material& m = rod_.effects.material;
    const double slope = effects::materialResponse(rod_.model, m, element, curvature, curvature, kUnit).tangent -
                         m.model.viscosity / kUnit * rod_.model.definition().bendingModulus;
    return std::max(0.0, slope) * rod_.model.elementLength(element);
}

/// Force of bending and damping at a stage.
void FreeMotion::addBending(const FreeStage& s) {
    const rod::RodModel& model = rod_.model;
    const bool effects = rod_.effects.material.on();
    if (!effects)
        rod::addBendingForce(model, s.q, f_.force);
    for (int k = 0; k < model.elements(); ++k) {
        const int element = model.elementOfDof(k);
        if (effects) // without a change there is no viscous moment
            f_.force[k] -= model.elementLength(element) *
                           effects::materialResponse(model, rod_.effects.material, element, s.q[k], s.q[k], 1.0).moment;
        f_.force[k] -= viscosity_ * rod::bendingStiffness(model, element) * s.v[k];
    }
}

/// Rows of the centre of mass, times the mass.
void FreeMotion::meanRows() {
    for (int axis = 0; axis < 2; ++axis)
        rod::uniformForce(rod_.model, w_.kin, w_.gauss, Vec2::Unit(axis), f_.mean[axis]);
}

/// Forces and torques that somebody applies.
void FreeMotion::addForces() {
    if (rod_.forces.empty())
        return;
    const rod::RodModel& model = rod_.model;
    HoldWork& s = w_.held;
    s.pair.resize(2, n_);
    s.turn.resize(n_);
    meanRows();
    for (const AppliedForce& a : rod_.forces) {
        const rod::MaterialPoint at = rod::locate(model, a.s);
        w_.kin.pointRows(model, at, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), s.pair);
        w_.kin.angleRow(model, at, s.turn);
        const Vec2 centre = f_.force.segment<2>(x());
        f_.force.noalias() += s.pair.transpose() * a.force;
        f_.force -= (a.force.x() * f_.mean[0] + a.force.y() * f_.mean[1]) / mass();
        f_.force += a.torque * s.turn.transpose();
        f_.force.segment<2>(x()) = centre + a.force;
    }
}

/// Rows of the holds at the geometry evaluated last, about the centre of mass; A^-1 C^T.
void FreeMotion::holdRows() {
    const rod::RodModel& model = rod_.model;
    const bool closed = model.definition().closed;
    Eigen::Index rows = closed ? 3 : 0;
    for (const Hold& h : rod_.holds)
        rows += h.clamped ? 3 : 2;
    f_.C.resize(rows, n_);
    Eigen::Index row = 0;
    HoldWork& s = w_.held;
    s.pair.resize(2, n_);
    s.otherPair.resize(2, n_);
    s.turn.resize(n_);
    s.otherTurn.resize(n_);
    if (!rod_.holds.empty())
        meanRows();
    for (const Hold& h : rod_.holds) {
        const rod::MaterialPoint at = rod::locate(model, h.s);
        w_.kin.pointRows(model, at, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), s.pair);
        for (int axis = 0; axis < 2; ++axis) {
            f_.C.row(row) = s.pair.row(axis) - f_.mean[axis].transpose() / mass();
            f_.C.row(row).segment<2>(x()) = Vec2::Unit(axis);
            ++row;
        }
        if (h.clamped) {
            w_.kin.angleRow(model, at, s.turn);
            f_.C.row(row++) = s.turn;
        }
    }
    if (closed) { // both ends are one material point
        const double L = model.definition().length;
        const rod::MaterialPoint first = rod::locate(model, 0, 0.0);
        const rod::MaterialPoint last = rod::locate(model, model.elements() - 1, L);
        w_.kin.pointRows(model, last, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), s.pair);
        w_.kin.pointRows(model, first, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), s.otherPair);
        f_.C.middleRows(row, 2) = s.pair - s.otherPair;
        w_.kin.angleRow(model, last, s.turn);
        w_.kin.angleRow(model, first, s.otherTurn);
        f_.C.row(row + 2) = s.turn - s.otherTurn;
    }
    f_.solved = f_.C.transpose();
    w_.llt.solveInPlace(f_.solved);
    f_.schur.noalias() = f_.C * f_.solved;
    f_.schurFactor.compute(f_.schur);
}

/// f_.impulse = (C A^-1 C^T)^-1 f_.impulse, where holds that others make redundant take nothing.
void FreeMotion::solveSchur() {
    constexpr double kRedundant = 1e-12; // of the largest pivot: those of two clamps on a stiff piece are 1e-16 of it
    const auto& factor = f_.schurFactor;
    const auto pivots = factor.vectorD();
    const double least = kRedundant * pivots.maxCoeff();
    f_.impulse = factor.transpositionsP() * f_.impulse;
    factor.matrixL().solveInPlace(f_.impulse);
    for (Eigen::Index i = 0; i < pivots.size(); ++i)
        f_.impulse[i] = pivots[i] > least ? f_.impulse[i] / pivots[i] : 0.0;
    factor.matrixU().solveInPlace(f_.impulse);
    f_.impulse = factor.transpositionsP().transpose() * f_.impulse;
}

/// Velocities of the holds `ahead` s after the start of the step.
void FreeMotion::holdRates(double ahead) {
    f_.rates.setZero(f_.C.rows());
    Eigen::Index row = 0;
    for (const Hold& h : rod_.holds) {
        const Pose p = poseAfter(world_, h, ahead);
        f_.rates.segment<2>(row) = p.velocity;
        row += 2;
        if (h.clamped)
            f_.rates[row++] = p.spin;
    }
}

/// Adds A^-1 C^T y to `change`, so that C change = rates; f_.impulse = y. Redundant holds drop out.
void FreeMotion::constrain(const Eigen::VectorXd& rates, Eigen::VectorXd& change) {
    f_.impulse = rates;
    f_.impulse.noalias() -= f_.C * change;
    solveSchur();
    change.noalias() += f_.solved * f_.impulse;
}

/// Solves a stage from s.q0, s.p0 with the guess s.v, at the time `ahead`: s.q, s.p, s.v, s.impulse.
bool FreeMotion::stage(double tau, double ahead, FreeStage& s) {
    const rod::RodModel& model = rod_.model;
    const double h = model.definition().length;
    // A hundredth of this would be lost in round-off, a hundred times of it would be seen in the angular momentum of
    // long runs.
    const double tolerance = 1e-4 * settings_.contact.tolerance, floor = 1e-13 * h / tau * std::sqrt(mass());
    double last = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMostIterations; ++i) {
        ++f_.iterations;
        s.q = s.q0 + tau * s.v;
        evaluate(s.q, s.v);
        rod::inertialForce(model, w_.kin, w_.gauss, f_.rate, f_.u, f_.force);
        f_.force[model.dofTheta()] = 0.0; // it is round-off: nothing turns a rod about its centre of mass
        addBending(s);
        f_.force.segment<2>(x()) = mass() * world_.gravity;
        addForces();
        rod::momentum(model, w_.kin, w_.gauss, f_.u, f_.product);
        f_.product.segment<2>(x()) = mass() * s.v.segment<2>(x());
        s.p = s.p0 + tau * f_.force;
        s.change = s.p - f_.product;
        w_.llt.solveInPlace(s.change);
        if (f_.hasHolds) {
            holdRows();
            holdRates(ahead);
            f_.rates.noalias() -= f_.C * s.v;
            constrain(f_.rates, s.change);
            s.impulse = f_.impulse;
            s.p.noalias() += f_.C.transpose() * s.impulse;
        }
        f_.product.noalias() = w_.A * s.change;
        const double size = std::sqrt(std::max(0.0, s.change.dot(f_.product)));
        f_.shape = s.v;
        f_.shape.segment<2>(x()).setZero();
        f_.product.noalias() = w_.A * f_.shape;
        const double motion = std::sqrt(std::max(0.0, f_.shape.dot(f_.product)));
        s.v += s.change;
        if (!std::isfinite(size))
            return false;
        if (size <= tolerance * motion + floor) {
            s.q = s.q0 + tau * s.v;
            return true;
        }
        if (i > 2 && size > 0.7 * last) // too slow to come to an end, or at the end of the digits
            return size <= 1e3 * (tolerance * motion + floor);
        last = size;
    }
    return false;
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
        constrain(f_.rates, f_.change);
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

/// Puts the rod back to its holds, from which the velocities have led it by an error of third order.
void FreeMotion::closeHolds(double ahead) {
    const rod::RodModel& model = rod_.model;
    f_.missing.resize(f_.C.rows());
    Eigen::Index row = 0;
    for (const Hold& h : rod_.holds) {
        const rod::MaterialPoint at = rod::locate(model, h.s);
        const Pose goal = poseAfter(world_, h, ahead);
        f_.missing.segment<2>(row) = goal.point - (w_.kin.point(at) + f_.middle);
        row += 2;
        if (h.clamped)
            f_.missing[row++] = goal.angle - w_.kin.angle(at);
    }
    if (model.definition().closed) {
        const rod::MaterialPoint first = rod::locate(model, 0, 0.0);
        const rod::MaterialPoint last = rod::locate(model, model.elements() - 1, model.definition().length);
        f_.missing.segment<2>(row) = w_.kin.point(first) - w_.kin.point(last);
        const double total = w_.kin.angle(last) - w_.kin.angle(first);
        f_.missing[row + 2] = 2.0 * M_PI * std::round(total / (2.0 * M_PI)) - total;
    }
    f_.impulse = f_.missing;
    solveSchur();
    f_.q.noalias() += f_.solved * f_.impulse;
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

/// One step of `size` s from `start` s on. False: it must be shorter.
bool FreeMotion::tryStep(double start, double size) {
    const rod::RodModel& model = rod_.model;
    const double tau = kGamma * size;
    evaluate(f_.q, f_.v);
    factor(tau);
    FreeStage &one = f_.stages[0], &two = f_.stages[1];
    one.q0 = f_.q;
    one.p0 = f_.p;
    one.v = f_.v;
    if (!stage(tau, start + tau, one))
        return false;
    two.q0 = f_.q + kExtrapolate * (one.q - f_.q);
    two.p0 = f_.p + kExtrapolate * (one.p - f_.p);
    two.v = f_.v + (one.v - f_.v) / kGamma;
    if (!stage(tau, start + size, two))
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
            f_.rates.resize(s.impulse.size());
            holdRates(i == 0 ? start + tau : start + size);
            f_.holdWork += weight * s.impulse.dot(f_.rates);
        }
        for (int k = 0; k < model.elements(); ++k)
            f_.damped +=
                weight * tau * viscosity_ * rod::bendingStiffness(model, model.elementOfDof(k)) * s.v[k] * s.v[k];
    }
    f_.tau = tau;
    if (f_.hasHolds) {
        evaluate(f_.q, f_.v);
        closeHolds(start + size);
    }
    ++f_.steps;
    return true;
}

void FreeMotion::measureWay() {
    const rod::RodModel& model = rod_.model;
    evaluate(f_.q, f_.v);
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
    w_.C.resize(0, n_);
    w_.vFree = w_.v;
    w_.body = -1;
    w_.frozen = w_.touching = w_.loaded = false;
    w_.rollingCount = 0;
    w_.load.resize(0);
    w_.mouseJoints.clear();
    w_.impactShare = 0.0;
    w_.contactImpulse.setZero(n_);
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
