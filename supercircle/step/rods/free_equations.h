#pragma once
// The equations of one rod in a stage of free motion (private to step/rods; the scheme is said in free_motion.h). q, p
// and v have the centre of mass in place of the middle.

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/rods/rod_system.h"

namespace supercircle::step {

/// Of all damping of a rod, over B, s.
[[nodiscard]] double viscosityOf(const Rod& rod);

class FreeEquations {
public:
    FreeEquations(const World& world, const Rod& rod, RodWork& w)
        : world_(world), rod_(rod), w_(w), f_(w.free), n_(rod.model.dofs()), viscosity_(viscosityOf(rod)) {}

    /// Geometry at q, and the velocities about the centre of mass that v makes there.
    void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
    /// A = M + tau^2 K + tau D, at the geometry evaluated last and the curvatures of `q`.
    /// `pulled`: with the geometric stiffness RodWork::axial.
    void factor(double tau, const Eigen::VectorXd& q, bool pulled);
    /// What a stage, `ahead` s from the start of the whole step, leaves of its equation at the guess s.v: s.q, s.p, and
    /// s.change = A^-1 (p(Q) + tau F - M v).
    void residual(double tau, double ahead, FreeStage& s);
    /// Rows of the holds at the geometry evaluated last, about the centre of mass, and room for those of joints.
    void holdRows();
    /// Adds the rows of a point `offset` from the centre line, times `sign`, to rows of joints; those of its angle.
    void addPointRows(const rod::MaterialPoint& at, const Vec2& offset, double sign, Eigen::Index row);
    void addAngleRow(const rod::MaterialPoint& at, double sign, Eigen::Index row);
    /// The same of a point along `axis` alone.
    void addPointRow(const rod::MaterialPoint& at, const Vec2& offset, const Vec2& axis, double sign, Eigen::Index row);
    /// A^-1 C^T and C A^-1 C^T.
    void eliminate();
    [[nodiscard]] double viscosity() const { return viscosity_; }

private:
    [[nodiscard]] Eigen::Index x() const { return rod_.model.dofX(); }
    [[nodiscard]] double mass() const { return rod_.model.mass(); }
    [[nodiscard]] double tangentOf(int element, double curvature) const;
    void addBending(double tau, double ahead, FreeStage& s);
    void meanRows();
    void addForces();
    void rowAlong(const rod::MaterialPoint& at, const Vec2& offset, const Vec2& axis);
    void airRow(std::size_t point);
    void addAirTangent(double tau);
    void addAir(FreeStage& s);
    void centredRows(const rod::MaterialPoint& at, const Vec2& offset);
    [[nodiscard]] MouseForce mouseForceAt(const MouseJoint& joint, const Eigen::VectorXd& v);
    void addMouseTangent(double tau);
    void addMouseJoints(FreeStage& s);

    const World& world_;
    const Rod& rod_;
    RodWork& w_;
    FreeWork& f_;
    Eigen::Index n_;
    double viscosity_;
};

} // namespace supercircle::step
