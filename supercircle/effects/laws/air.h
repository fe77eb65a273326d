#pragma once
// Air against the normal of a rod: at each quadrature point a force over its speed, without memory.

#include "supercircle/effects/model.h"
#include "supercircle/rod/kinematics.h"

namespace supercircle::effects {

/// An air model on a rod: plain data.
struct Air {
    AirModel model;
    std::vector<rod::MaterialPoint> points; ///< quadrature points
    std::vector<double> weight;             ///< length of rod per quadrature point, m
    [[nodiscard]] bool on() const { return !points.empty(); }
};

Air makeAir(const rod::RodModel& rod, const AirModel& model);

/// Against the motion of a point with `speed` along the normal, m/s.
struct AirResponse {
    double force = 0.0; ///< against the normal, N
    double slope = 0.0; ///< its derivative by the speed, N s/m
};
AirResponse airAt(const Air& air, std::size_t point, double speed);

/// Unit normal of the rod at a point.
Vec2 normalAt(const rod::Kinematics& kin, const rod::MaterialPoint& at);

} // namespace supercircle::effects
