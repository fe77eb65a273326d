#pragma once
// The equations of a stage of free motion (private to step/rods; the scheme is said in free_motion.h). q, p and v have
// the centre of mass in place of the middle.

#include "supercircle/step/rods/rod_system.h"

namespace supercircle::step {

/// Of all damping of a rod, over B, s.
[[nodiscard]] double viscosityOf(const Rod& rod);

class FreeEquations {
public:
    FreeEquations(const World& world, const Settings& settings, const Rod& rod, RodWork& w)
        : world_(world), rod_(rod), w_(w), f_(w.free), n_(rod.model.dofs()), viscosity_(viscosityOf(rod)),
          tolerance_(1e-4 * settings.contact.tolerance) {}

    /// Geometry at q, and the velocities about the centre of mass that v makes there.
    void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd& v);
    /// A = M + tau^2 K + tau D, at the geometry evaluated last and the curvatures of `q`.
    void factor(double tau, const Eigen::VectorXd& q);
    /// Solves a stage from s.q0, s.p0 with the guess s.v, at the time `ahead`: s.q, s.p, s.v, s.impulse. False: its
    /// iteration does not come to an end.
    [[nodiscard]] bool solve(double tau, double ahead, FreeStage& s);
    /// Adds A^-1 C^T y to `change`, so that C change = rates; f.impulse = y. Redundant holds drop out.
    void constrain(const Eigen::VectorXd& rates, Eigen::VectorXd& change);
    /// Puts q, whose geometry was evaluated last, back to the holds, from which the velocities have led it by an error
    /// of third order.
    void closeHolds(double ahead, Eigen::VectorXd& q);
    [[nodiscard]] double viscosity() const { return viscosity_; }

private:
    [[nodiscard]] Eigen::Index x() const { return rod_.model.dofX(); }
    [[nodiscard]] double mass() const { return rod_.model.mass(); }
    [[nodiscard]] double tangentOf(int element, double curvature) const;
    void addBending(const FreeStage& s);
    void meanRows();
    void addForces();
    void holdRows();
    void solveSchur();

    const World& world_;
    const Rod& rod_;
    RodWork& w_;
    FreeWork& f_;
    Eigen::Index n_;
    double viscosity_;
    /// Of a stage, relative to its motion. A hundredth of it would be lost in round-off, a hundred times of it would be
    /// seen in the angular momentum of long runs.
    double tolerance_;
};

} // namespace supercircle::step
