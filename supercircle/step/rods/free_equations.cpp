#include "supercircle/step/rods/free_equations.h"

#include "supercircle/step/rods/hold_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::step {

namespace {

constexpr int kMostIterations = 16; ///< of a stage; twice as many seldom save a step

} // namespace

double viscosityOf(const Rod& rod) {
    return rod.dampingTime + (rod.effects.material.on() ? rod.effects.material.model.viscosity : 0.0);
}

void FreeEquations::evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
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

/// Motion about the centre of mass takes the mean out of J.
void FreeEquations::factor(double tau, const Eigen::VectorXd& q) {
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
        w_.A(i, i) += tau * (tau * tangentOf(element, q[i]) + viscosity_ * rod::bendingStiffness(model, element));
    }
    w_.llt.compute(w_.A);
}

/// Slope of the elastic moment of an element times its length, N m^3.
double FreeEquations::tangentOf(int element, double curvature) const {
    if (!rod_.effects.material.on())
        return rod::bendingStiffness(rod_.model, element);
    constexpr double kUnit = 1.0; // s: of a step without change, whose viscous part is known
    const effects::Material& m = rod_.effects.material;
    const double slope = effects::materialResponse(rod_.model, m, element, curvature, curvature, kUnit).tangent -
                         m.model.viscosity / kUnit * rod_.model.definition().bendingModulus;
    return std::max(0.0, slope) * rod_.model.elementLength(element);
}

/// Force of bending and damping at a stage.
void FreeEquations::addBending(const FreeStage& s) {
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
void FreeEquations::meanRows() {
    for (int axis = 0; axis < 2; ++axis)
        rod::uniformForce(rod_.model, w_.kin, w_.gauss, Vec2::Unit(axis), f_.mean[axis]);
}

/// Forces and torques that somebody applies.
void FreeEquations::addForces() {
    if (rod_.forces.empty())
        return;
    const rod::RodModel& model = rod_.model;
    w_.rowsOfLoad.resize(2, n_);
    f_.turn.resize(n_);
    meanRows();
    for (const AppliedForce& a : rod_.forces) {
        const rod::MaterialPoint at = rod::locate(model, a.s);
        w_.kin.pointRows(model, at, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), w_.rowsOfLoad);
        w_.kin.angleRow(model, at, f_.turn);
        const Vec2 centre = f_.force.segment<2>(x());
        f_.force.noalias() += w_.rowsOfLoad.transpose() * a.force;
        f_.force -= (a.force.x() * f_.mean[0] + a.force.y() * f_.mean[1]) / mass();
        f_.force += a.torque * f_.turn.transpose();
        f_.force.segment<2>(x()) = centre + a.force;
    }
}

/// Rows of the holds at the geometry evaluated last, about the centre of mass; A^-1 C^T.
void FreeEquations::holdRows() {
    step::holdRows(rod_.model, rod_.holds, w_.kin, f_.C);
    if (!rod_.holds.empty())
        meanRows();
    Eigen::Index row = 0;
    for (const Hold& h : rod_.holds) {
        for (int axis = 0; axis < 2; ++axis) {
            f_.C.row(row + axis) -= f_.mean[axis].transpose() / mass();
            f_.C.row(row + axis).segment<2>(x()) = Vec2::Unit(axis);
        }
        row += h.clamped ? 3 : 2;
    }
    f_.solved = f_.C.transpose();
    w_.llt.solveInPlace(f_.solved);
    f_.schur.noalias() = f_.C * f_.solved;
    f_.schurFactor.compute(f_.schur);
}

/// f_.impulse = (C A^-1 C^T)^-1 f_.impulse, where holds that others make redundant take nothing.
void FreeEquations::solveSchur() {
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

void FreeEquations::constrain(const Eigen::VectorXd& rates, Eigen::VectorXd& change) {
    f_.impulse = rates;
    f_.impulse.noalias() -= f_.C * change;
    solveSchur();
    change.noalias() += f_.solved * f_.impulse;
}

void FreeEquations::closeHolds(double ahead, Eigen::VectorXd& q) {
    holdGaps(world_, rod_, w_.kin, f_.middle, ahead, f_.impulse);
    solveSchur();
    q.noalias() += f_.solved * f_.impulse;
}

bool FreeEquations::solve(double tau, double ahead, FreeStage& s) {
    const rod::RodModel& model = rod_.model;
    const double floor = 1e-13 * model.definition().length / tau * std::sqrt(mass());
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
            holdRates(world_, rod_, ahead, f_.rates);
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
        if (size <= tolerance_ * motion + floor) {
            s.q = s.q0 + tau * s.v;
            return true;
        }
        if (i > 2 && size > 0.7 * last) // too slow to come to an end, or at the end of the digits
            return size <= 1e3 * (tolerance_ * motion + floor);
        last = size;
    }
    return false;
}

} // namespace supercircle::step
