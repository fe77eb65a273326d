#include "supercircle/step/rods/free_equations.h"

#include "supercircle/step/rods/free_material.h"
#include "supercircle/step/rods/hold_rows.h"
#include "supercircle/step/rods/hold_springs.h"
#include "supercircle/support/invariants.h"

#include <algorithm>

namespace supercircle::step {

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
void FreeEquations::factor(double tau, const Eigen::VectorXd& q, bool pulled) {
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
    for (int i = 0; i < model.elements(); ++i)
        w_.A(i, i) += tau * tau * tangentOf(model.elementOfDof(i), q[i]);
    if (rod_.effects.material.on()) {
        effects::springNeighbours(model, rod_.effects.material, q, 0.0, f_.pairs);
        effects::addNeighbourStiffness(model, f_.pairs, tau * tau, w_.A);
    } else {
        rod::addNeighbourStiffness(model, tau * tau, w_.A);
    }
    if (viscosity_ > 0.0)
        rod::addBendingStiffness(model, tau * viscosity_, w_.A);
    addRelaxingTangent(rod_, tau, w_.A);
    addHoldSpringStiffness(rod_, w_.kin, tau * tau, w_.A);
    addAirTangent(tau);
    addMouseTangent(tau);
    if (pulled)
        w_.A += tau * tau * w_.axial;
    w_.llt.compute(w_.A);
}

/// Slope of the elastic moment of an element times its length, N m^3.
double FreeEquations::tangentOf(int element, double curvature) const {
    if (!rod_.effects.material.on())
        return rod::bendingStiffness(rod_.model, element);
    const double slope = effects::springResponse(rod_.model, rod_.effects.material, element, curvature, 0.0).tangent;
    return std::max(0.0, slope) * rod_.model.elementLength(element);
}

/// Force of bending and damping at a stage.
void FreeEquations::addBending(double tau, double ahead, FreeStage& s) {
    const rod::RodModel& model = rod_.model;
    const bool effects = rod_.effects.material.on();
    if (!effects)
        rod::addBendingForce(model, s.q, f_.force);
    for (int k = 0; effects && k < model.elements(); ++k) {
        const int element = model.elementOfDof(k);
        f_.force[k] -= model.elementLength(element) *
                       effects::springResponse(model, rod_.effects.material, element, s.q[k], ahead).moment;
    }
    if (effects) {
        effects::springNeighbours(model, rod_.effects.material, s.q, ahead, f_.pairs);
        for (const effects::NeighbourResponse& p : f_.pairs) {
            f_.force[model.dofOfElement(p.before)] += p.forceBefore;
            f_.force[model.dofOfElement(p.after)] += p.forceAfter;
        }
    }
    if (viscosity_ > 0.0)
        rod::addBendingDrag(model, viscosity_, s.v, f_.force);
    addRelaxing(rod_, tau, s, f_.force);
    addHoldSpringForce(world_, rod_, w_.kin, ahead, 1.0, f_.force);
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

void FreeEquations::holdRows() {
    step::holdRows(rod_.model, rod_.holds, w_.kin, f_.heldRows);
    const auto rows = static_cast<Eigen::Index>(f_.place.size());
    SC_ASSERT(f_.heldRows.rows() == f_.held && f_.held <= rows, "rows of holds come first");
    f_.C.setZero(rows, n_);
    f_.C.topRows(f_.held) = f_.heldRows;
    if (!rod_.holds.empty() || rows > f_.held)
        meanRows();
    Eigen::Index row = 0;
    for (const Hold& h : rod_.holds) {
        for (int axis = 0; axis < 2; ++axis) {
            f_.C.row(row + axis) -= f_.mean[axis].transpose() / mass();
            f_.C.row(row + axis).segment<2>(x()) = Vec2::Unit(axis);
        }
        row += h.rows();
    }
}

/// Into `rowsOfLoad`: the rows of a point about the centre of mass.
void FreeEquations::centredRows(const rod::MaterialPoint& at, const Vec2& offset) {
    w_.rowsOfLoad.resize(2, n_);
    w_.kin.pointRows(rod_.model, at, offset, Vec2::UnitX(), Vec2::UnitY(), w_.rowsOfLoad);
    for (int axis = 0; axis < 2; ++axis) {
        w_.rowsOfLoad.row(axis) -= f_.mean[axis].transpose() / mass();
        w_.rowsOfLoad.row(axis).segment<2>(x()) = Vec2::Unit(axis);
    }
}

void FreeEquations::addPointRows(const rod::MaterialPoint& at, const Vec2& offset, double sign, Eigen::Index row) {
    centredRows(at, offset);
    f_.C.middleRows<2>(row) += sign * w_.rowsOfLoad;
}

void FreeEquations::addAngleRow(const rod::MaterialPoint& at, double sign, Eigen::Index row) {
    f_.turn.resize(n_);
    w_.kin.angleRow(rod_.model, at, f_.turn);
    f_.C.row(row) += sign * f_.turn;
}

/// Into `turn`: the row of a point along an axis, about the centre of mass.
void FreeEquations::rowAlong(const rod::MaterialPoint& at, const Vec2& offset, const Vec2& axis) {
    w_.rowsOfLoad.resize(2, n_);
    w_.kin.pointRows(rod_.model, at, offset, axis, rod::perp(axis), w_.rowsOfLoad);
    f_.turn = w_.rowsOfLoad.row(0) - (axis.x() * f_.mean[0] + axis.y() * f_.mean[1]).transpose() / mass();
    f_.turn.segment<2>(x()) = axis;
}

void FreeEquations::addPointRow(const rod::MaterialPoint& at, const Vec2& offset, const Vec2& axis, double sign,
                                Eigen::Index row) {
    rowAlong(at, offset, axis);
    f_.C.row(row) += sign * f_.turn;
}

void FreeEquations::airRow(std::size_t point) {
    const rod::MaterialPoint& at = rod_.effects.air.points[point];
    rowAlong(at, Vec2::Zero(), effects::normalAt(w_.kin, at));
}

/// Of the speeds at the start of the step.
void FreeEquations::addAirTangent(double tau) {
    const effects::Air& air = rod_.effects.air;
    if (!air.on())
        return;
    meanRows();
    for (std::size_t i = 0; i < air.points.size(); ++i) {
        airRow(i);
        const double slope = effects::airAt(air, i, f_.turn.dot(f_.v)).slope;
        w_.A.noalias() += (tau * slope) * f_.turn.transpose() * f_.turn;
    }
}

void FreeEquations::addAir(FreeStage& s) {
    const effects::Air& air = rod_.effects.air;
    s.airPower = 0.0;
    if (!air.on())
        return;
    meanRows();
    for (std::size_t i = 0; i < air.points.size(); ++i) {
        airRow(i);
        const double speed = f_.turn.dot(s.v), force = effects::airAt(air, i, speed).force;
        f_.force -= force * f_.turn.transpose();
        s.airPower += force * speed;
    }
}

/// Of a mouse joint, whose point moves with the generalised velocities `v`; its rows are left in `rowsOfLoad`.
MouseForce FreeEquations::mouseForceAt(const MouseJoint& joint, const Eigen::VectorXd& v) {
    const rod::MaterialPoint at = rod::locate(rod_.model, joint.s);
    centredRows(at, Vec2::Zero());
    return mouseForce(joint, w_.kin.point(at) + f_.middle, w_.rowsOfLoad * v);
}

/// As at the start of the step. At its largest force a joint gives way along it: only its direction is stiff.
void FreeEquations::addMouseTangent(double tau) {
    if (rod_.mouseJoints.empty())
        return;
    meanRows();
    for (const MouseJoint& joint : rod_.mouseJoints) {
        const MouseForce at = mouseForceAt(joint, f_.v);
        Eigen::Matrix2d stiff = at.share * tau * (joint.damping + tau * joint.stiffness) * Eigen::Matrix2d::Identity();
        if (at.share < 1.0) {
            const Vec2 along = at.force.normalized();
            stiff -= stiff(0, 0) * along * along.transpose();
        }
        w_.A.noalias() += w_.rowsOfLoad.transpose() * stiff * w_.rowsOfLoad;
    }
}

void FreeEquations::addMouseJoints(FreeStage& s) {
    s.mousePower = 0.0;
    if (rod_.mouseJoints.empty())
        return;
    meanRows();
    for (const MouseJoint& joint : rod_.mouseJoints) {
        const Vec2 force = mouseForceAt(joint, s.v).force;
        f_.force.noalias() += w_.rowsOfLoad.transpose() * force;
        s.mousePower += force.dot(w_.rowsOfLoad * s.v);
    }
}

void FreeEquations::eliminate() {
    f_.solved = f_.C.transpose();
    if (f_.C.rows() > 0) // Eigen forms a reference to the first number even where there is none
        w_.llt.solveInPlace(f_.solved);
    f_.schur.noalias() = f_.C * f_.solved;
}

void FreeEquations::residual(double tau, double ahead, FreeStage& s) {
    const rod::RodModel& model = rod_.model;
    s.q = s.q0 + tau * s.v;
    evaluate(s.q, s.v);
    rod::inertialForce(model, w_.kin, w_.gauss, f_.rate, f_.u, f_.force);
    f_.force[model.dofTheta()] = 0.0; // it is round-off: nothing turns a rod about its centre of mass
    addBending(tau, ahead, s);
    f_.force.segment<2>(x()) = mass() * world_.gravity;
    addForces();
    addAir(s);
    addMouseJoints(s);
    rod::momentum(model, w_.kin, w_.gauss, f_.u, f_.product);
    f_.product.segment<2>(x()) = mass() * s.v.segment<2>(x());
    s.p = s.p0 + tau * f_.force;
    s.change = s.p - f_.product;
    w_.llt.solveInPlace(s.change);
}

} // namespace supercircle::step
