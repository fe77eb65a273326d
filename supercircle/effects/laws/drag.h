#pragma once
// Planar dry friction: every point of a rod is pressed against walls in front and behind. It resists motion in the
// plane with a force f per length, at any speed.
//
// The law is set-valued at rest. It is regularised in displacement, not in speed (decision 0127): each quadrature point
// carries a spring of length up to `presliding` that follows it and slips when stretched further (Prandtl 1928; radial
// return in the plane). A point at rest does not creep, the result does not depend on the rate, the dissipation is f
// times the slip, and tangents are symmetric and positive.

#include "supercircle/effects/model.h"
#include "supercircle/rod/kinematics.h"

namespace supercircle::effects {

/// A drag model on a rod and its state: plain data.
struct Drag {
    DragModel model;
    std::vector<rod::MaterialPoint> points; ///< quadrature points
    std::vector<double> weight;             ///< length of rod per quadrature point, m
    std::vector<Vec2> stretch;              ///< of the springs, m: |stretch| <= presliding
    [[nodiscard]] bool on() const { return !points.empty(); }
};

Drag makeDrag(const rod::RodModel& rod, const DragModel& model);

/// Force on a point that moves by `displacement` in a step, with its derivative.
struct DragResponse {
    Vec2 force = Vec2::Zero();                           ///< N
    Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero(); ///< -d force / d displacement, positive semidefinite, N/m
    Vec2 stretch = Vec2::Zero();                         ///< at the end of the step, m
    double slipped = 0.0;                                ///< slip in the step, m
};
/// `secant`: secant stiffness (always sufficient for convergence) instead of the tangent.
DragResponse dragAt(const Drag& drag, std::size_t point, const Vec2& displacement, bool secant = false);

/// Energy of the springs, J.
double storedEnergy(const Drag& drag);

} // namespace supercircle::effects
