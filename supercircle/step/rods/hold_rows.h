#pragma once
// What the holds of a rod, and the ends of a ring, ask of its motion (private to step/): rows C of their points and
// angles, and how far these are from where they are to be. Order: each hold's x, y and, where a clamp fixes it, angle;
// then x, y and angle of the last end of a ring against the first.

#include "supercircle/step/world.h"

namespace supercircle::step {

[[nodiscard]] Eigen::Index holdRowCount(const rod::RodModel& model, const std::vector<Hold>& holds);
/// Rows at `kin`, m x n, overwritten.
void holdRows(const rod::RodModel& model, const std::vector<Hold>& holds, const rod::Kinematics& kin,
              Eigen::MatrixXd& C);
/// Where they are to be `ahead` s after World::time, less where they are at `kin` moved by `shift`; m, rad.
void holdGaps(const World& world, const Rod& rod, const rod::Kinematics& kin, const Vec2& shift, double ahead,
              Eigen::VectorXd& gaps);
/// The velocities that they are to have then; m/s, rad/s.
void holdRates(const World& world, const Rod& rod, double ahead, Eigen::VectorXd& rates);

/// Calls `visit(first row, has an angle)` for each point.
void forEachHeldPoint(const rod::RodModel& model, const std::vector<Hold>& holds, const auto& visit) {
    Eigen::Index row = 0;
    for (const Hold& h : holds) {
        visit(row, h.fixesAngle());
        row += h.rows();
    }
    if (model.definition().closed)
        visit(row, true);
}

} // namespace supercircle::step
