#include "supercircle/step/rods/hold_rows.h"

#include "supercircle/step/applied_forces.h"
#include "supercircle/support/invariants.h"

#include <cmath>

namespace supercircle::step {

Eigen::Index holdRowCount(const rod::RodModel& model, const std::vector<Hold>& holds) {
    Eigen::Index rows = 0;
    forEachHeldPoint(model, holds, [&](Eigen::Index, bool angle) { rows += angle ? 3 : 2; });
    return rows;
}

void holdRows(const rod::RodModel& model, const std::vector<Hold>& holds, const rod::Kinematics& kin,
              Eigen::MatrixXd& C) {
    C.resize(holdRowCount(model, holds), model.dofs());
    Eigen::Index row = 0;
    for (const Hold& h : holds) {
        const rod::MaterialPoint at = rod::locate(model, h.s);
        kin.pointRows(model, at, Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), C.middleRows<2>(row));
        if (h.fixesAngle())
            kin.angleRow(model, at, C.row(row + 2));
        row += h.rows();
    }
    if (model.definition().closed)
        kin.closureRows(model, C.middleRows<3>(row));
}

void holdGaps(const World& world, const Rod& rod, const rod::Kinematics& kin, const Vec2& shift, double ahead,
              Eigen::VectorXd& gaps) {
    gaps.resize(holdRowCount(rod.model, rod.holds));
    Eigen::Index row = 0;
    for (const Hold& h : rod.holds) {
        const rod::MaterialPoint at = rod::locate(rod.model, h.s);
        const Pose goal = poseAfter(world, h, ahead);
        gaps.segment<2>(row) = goal.point - (kin.point(at) + shift);
        if (h.fixesAngle())
            gaps[row + 2] = goal.angle - kin.angle(at);
        row += h.rows();
    }
    if (rod.model.definition().closed) { // both ends are one material point
        const rod::MaterialPoint first = rod::locate(rod.model, 0, 0.0);
        const rod::MaterialPoint last = rod::locate(rod.model, rod.model.elements() - 1, rod.model.definition().length);
        gaps.segment<2>(row) = kin.point(first) - kin.point(last);
        const double total = kin.angle(last) - kin.angle(first);
        gaps[row + 2] = 2.0 * M_PI * std::round(total / (2.0 * M_PI)) - total; // keeps the winding it was built with
    }
}

void holdRates(const World& world, const Rod& rod, double ahead, Eigen::VectorXd& rates) {
    rates.setZero(holdRowCount(rod.model, rod.holds));
    Eigen::Index row = 0;
    for (const Hold& h : rod.holds) {
        const Pose p = poseAfter(world, h, ahead);
        rates.segment<2>(row) = p.velocity;
        if (h.fixesAngle())
            rates[row + 2] = p.spin;
        row += h.rows();
    }
}

} // namespace supercircle::step
