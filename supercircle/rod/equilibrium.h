#pragma once
// Static equilibrium of one rod under dead loads and supports, by Newton's method with Lagrange multipliers.
//
// Stationary points of  E_b(q) - int lambda a . r ds - sum f . r(s_f)  subject to the supports. A support prescribes x,
// y or the angle of one section; a closed rod also has its two ends joined. The multipliers are the reactions.
// Displacement control is a support on the loaded point; it passes limit points that load control cannot pass. Loads
// and prescribed values are ramped from the start configuration. A load step that does not converge is halved. Newton
// finds unstable equilibria as well as stable ones and reports the stability (decision 0121).
//
// All quantities inside are dimensionless (L, B), so that tolerances mean the same for every rod:
// coordinates kappa L, x/L, theta; forces in B/L^2, moments in B/L.

#include "supercircle/rod/kinematics.h"

#include <numbers>
#include <string>
#include <vector>

namespace supercircle::rod {

/// A dead load on a material point: its direction is fixed, its point of application moves with the rod.
struct PointLoad {
    double s = 0.0;              ///< arc length from the first tip, m
    Vec2 force = Vec2::Zero();   ///< N
    Vec2 section = Vec2::Zero(); ///< point's offset from the centre line along tangent and normal, m
};

/// Prescribes some of x, y and angle of the section at s.
struct Support {
    double s = 0.0;               ///< arc length from the first tip, m
    bool fixX = false;            ///< prescribe x of the point
    bool fixY = false;            ///< prescribe y of the point
    bool fixAngle = false;        ///< prescribe the tangent angle
    Vec2 position = Vec2::Zero(); ///< prescribed position, m (only the fixed components matter)
    double angle = 0.0;           ///< prescribed tangent angle, rad, not reduced to one revolution
    Vec2 section = Vec2::Zero();  ///< point's offset from the centre line along tangent and normal, m
};

/// Position fixed, section free to rotate.
inline Support pin(double s, const Vec2& position) {
    return {s, true, true, false, position};
}
/// Position and angle fixed.
inline Support clamp(double s, const Vec2& position, double angle) {
    return {s, true, true, true, position, angle};
}

struct EquilibriumProblem {
    Vec2 gravity = Vec2::Zero(); ///< uniform acceleration, m/s^2
    std::vector<PointLoad> pointLoads;
    std::vector<Support> supports;
    double closureAngle =
        2.0 * std::numbers::pi; ///< closed rods: tangent angle of the last end minus that of the first, rad
};

struct EquilibriumOptions {
    double tolerance = 1e-10;  ///< on every dimensionless residual, 1; about 1e-13 can be reached
    int loadSteps = 1;         ///< initial number of load steps; a step is halved where Newton fails
    double minLoadStep = 1e-4; ///< smallest load fraction per step before the ramp fails, 1
    int iterationsPerStep = 40;
    double maxRotationPerIteration = 0.4; ///< largest rotation of any section in one Newton step, rad
};

/// What a support exerts on the rod.
struct Reaction {
    Vec2 force = Vec2::Zero(); ///< N
    double moment = 0.0;       ///< N m
};

struct Equilibrium {
    std::string failure;             ///< empty if converged, else what happened and what to try
    Eigen::VectorXd q;               ///< the equilibrium, or the last converged configuration of the ramp
    std::vector<Reaction> reactions; ///< one for each support, in the same order
    Reaction closureReaction;        ///< closed rods: what the first end exerts on the last one
    int iterations = 0;              ///< Newton iterations, all load steps and failed attempts together
    int loadSteps = 0;               ///< converged load steps
    double loadFraction = 0.0;       ///< largest converged load fraction, 1
    double residual = 0.0;           ///< largest dimensionless residual at q
    /// Smallest eigenvalue of the dimensionless tangent stiffness restricted to motions the supports allow, B/L.
    /// Positive: stable; about zero: free to move or critical; negative: unstable.
    double smallestStiffness = 0.0;

    [[nodiscard]] bool converged() const { return failure.empty(); }
};

/// Solves for the equilibrium, starting the ramp from `start` (n entries; unloaded, with the supports' values it has
/// there). Continuation: start from the previous solution, one load step.
Equilibrium solveEquilibrium(const RodModel& model, const EquilibriumProblem& problem, const Eigen::VectorXd& start,
                             const EquilibriumOptions& options = {});

/// Natural shape with the middle at `middle` and tangent angle `theta` there; the usual start.
Eigen::VectorXd naturalShape(const RodModel& model, const Vec2& middle = Vec2::Zero(), double theta = 0.0);

} // namespace supercircle::rod
