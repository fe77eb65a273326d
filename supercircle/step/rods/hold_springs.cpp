#include "supercircle/step/rods/hold_springs.h"

#include "supercircle/step/applied_forces.h"

namespace supercircle::step {

namespace {

/// Calls `visit(hold, row of its angle)` for each clamp that yields.
void forEachSpring(const Rod& rod, const rod::Kinematics& kin, const auto& visit) {
    for (const Hold& h : rod.holds) {
        if (!h.yields())
            continue;
        Eigen::RowVectorXd row(rod.model.dofs());
        kin.angleRow(rod.model, rod::locate(rod.model, h.s), row);
        visit(h, row);
    }
}

} // namespace

double torqueOfHoldSpring(const World& world, const Rod& rod, const Hold& hold, const rod::Kinematics& kin,
                          double ahead) {
    return hold.yields()
               ? hold.turnStiffness * (poseAfter(world, hold, ahead).angle - kin.angle(rod::locate(rod.model, hold.s)))
               : 0.0;
}

void addHoldSpringStiffness(const Rod& rod, const rod::Kinematics& kin, double factor, Eigen::MatrixXd& matrix) {
    forEachSpring(rod, kin, [&](const Hold& h, const Eigen::RowVectorXd& row) {
        matrix.noalias() += (factor * h.turnStiffness) * row.transpose() * row;
    });
}

void addHoldSpringForce(const World& world, const Rod& rod, const rod::Kinematics& kin, double ahead, double factor,
                        Eigen::VectorXd& force) {
    forEachSpring(rod, kin, [&](const Hold& h, const Eigen::RowVectorXd& row) {
        force += factor * torqueOfHoldSpring(world, rod, h, kin, ahead) * row.transpose();
    });
}

void addHoldSprings(const World& world, const Rod& rod, double dt, RodWork& w) {
    addHoldSpringStiffness(rod, w.kin, dt * dt, w.A);
    addHoldSpringForce(world, rod, rod.kin, dt, dt, w.rhs); // A brings the turning within the step
}

double holdSpringEnergy(const World& world, const Rod& rod, const rod::Kinematics& kin, double ahead) {
    double energy = 0.0;
    for (const Hold& h : rod.holds)
        if (const double torque = torqueOfHoldSpring(world, rod, h, kin, ahead); torque != 0.0)
            energy += 0.5 * torque * torque / h.turnStiffness;
    return energy;
}

} // namespace supercircle::step
