#pragma once
// Planar dry friction: every point of a rod is pressed against walls in front and behind and resists its motion in the
// plane with a force f per length, whatever the speed.
//
// The law is set-valued at rest. It is regularised in displacement, not in speed: each quadrature point carries a
// spring of length up to `presliding` (1 um) that follows it and slips when stretched further (Prandtl 1928; radial
// return in the plane). So a point at rest holds for ever - no creep - the answer does not depend on the rate, the
// dissipation is f times the way slipped, and tangents are symmetric and positive. A regularisation in speed was not
// taken: at rest it creeps at its own speed scale, and dwells of minutes are what recordings consist of.

#include "supercircle/effects/model.h"
#include "supercircle/rod/kinematics.h"

namespace supercircle::effects {

/// A drag model on a rod and its state: plain data.
struct Drag {
    DragModel model;
    std::vector<rod::Place> place; ///< of the quadrature points
    std::vector<double> weight;    ///< length they stand for, m
    std::vector<Vec2> stretch;     ///< of their springs, m: |stretch| <= presliding
    [[nodiscard]] bool on() const { return !place.empty(); }
};

Drag makeDrag(const rod::RodModel& rod, const DragModel& model);

/// Force on a point that moves by `way` in a step, with its derivative.
struct DragPoint {
    Vec2 force = Vec2::Zero();                           ///< N
    Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero(); ///< -d force / d way, positive semidefinite, N/m
    Vec2 stretch = Vec2::Zero();                         ///< at the end, m
    double slipped = 0.0;                                ///< m
};
/// `secant`: stiffness of the spring that gives this force (always enough for convergence) instead of the tangent.
DragPoint dragAt(const Drag& drag, std::size_t point, const Vec2& way, bool secant = false);

/// J
double storedEnergy(const Drag& drag);

} // namespace supercircle::effects
