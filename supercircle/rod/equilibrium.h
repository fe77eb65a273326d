#pragma once
// Static equilibrium of one rod under dead loads and holds, by Newton's method with Lagrange multipliers.
//
// Stationary points of  E_b(q) - int lambda a . r ds - sum f . r(s_f)  subject to the holds: points of the rod whose x,
// y and/or angle are prescribed, and, for a closed rod, its two ends joined. The multipliers are the reactions, so
// displacement control is a hold on the loaded point whose reaction is the load; it passes limit points that load
// control cannot. Loads and prescribed values are ramped from the start configuration by an adaptive homotopy: a step
// that does not converge is halved. Newton finds unstable equilibria as well as stable ones and reports which it is.
//
// Everything inside is made dimensionless with L and B, so tolerances mean the same for every rod:
// coordinates kappa L, x/L, theta; forces in B/L^2, moments in B/L.

#include "supercircle/rod/kinematics.h"

#include <numbers>
#include <string>
#include <vector>

namespace supercircle::rod {

/// A dead force on a material point: fixed direction, moves with the point.
struct PointForce {
    double s = 0.0;              ///< arc length from the first tip, m
    Vec2 force = Vec2::Zero();   ///< N
    Vec2 section = Vec2::Zero(); ///< point's offset from the centre line along tangent and normal, m
};

/// Holds some of x, y, angle of the section at s at prescribed values.
struct Hold {
    double s = 0.0;               ///< arc length from the first tip, m
    bool x = false;               ///< hold the x of the point
    bool y = false;               ///< hold the y of the point
    bool turn = false;            ///< hold the angle
    Vec2 position = Vec2::Zero(); ///< prescribed position, m (only the held components matter)
    double angle = 0.0;           ///< prescribed tangent angle, rad, not reduced to one revolution
    Vec2 section = Vec2::Zero();  ///< point's offset from the centre line along tangent and normal, m
};

/// Position held, section free to turn.
inline Hold pin(double s, const Vec2& position) {
    return {s, true, true, false, position};
}
/// Position and angle held.
inline Hold clamp(double s, const Vec2& position, double angle) {
    return {s, true, true, true, position, angle};
}

struct EquilibriumProblem {
    Vec2 gravity = Vec2::Zero(); ///< uniform acceleration, m/s^2
    std::vector<PointForce> forces;
    std::vector<Hold> holds;
    double ringTurning =
        2.0 * std::numbers::pi; ///< of a closed rod: angle of its last end minus that of its first, rad
};

struct EquilibriumOptions {
    double tolerance = 1e-10;   ///< on every dimensionless residual; about 1e-13 is reachable
    int loadSteps = 1;          ///< first attempt; halved where Newton fails
    double smallestStep = 1e-4; ///< fraction of the load below which the ramp gives up
    int iterationsPerStep = 40;
    double turnPerIteration = 0.4; ///< rad; longer Newton steps are shortened so that no section turns more
};

/// What a hold exerts on the rod.
struct Reaction {
    Vec2 force = Vec2::Zero(); ///< N
    double moment = 0.0;       ///< N m
};

struct Equilibrium {
    std::string failure;             ///< empty if converged, else what happened and what to try
    Eigen::VectorXd q;               ///< the equilibrium, or the last converged configuration of the ramp
    std::vector<Reaction> reactions; ///< one a hold, in their order
    Reaction joint;                  ///< closed rods: what the first end exerts on the last one
    int iterations = 0;              ///< Newton iterations, all load steps and failed attempts together
    int loadSteps = 0;               ///< converged load steps
    double reached = 0.0;            ///< load fraction reached, 1 if converged
    double residual = 0.0;           ///< largest dimensionless residual at q
    /// Smallest eigenvalue of the dimensionless tangent stiffness restricted to motions the holds allow, B/L.
    /// Positive: stable; about zero: free to move or critical; negative: unstable.
    double smallestStiffness = 0.0;

    [[nodiscard]] bool converged() const { return failure.empty(); }
};

/// Solves for the equilibrium, starting the ramp from `start` (n entries; unloaded, with the holds' values it has
/// there). Continuation: start from the previous solution, one load step.
Equilibrium solveEquilibrium(const RodModel& model, const EquilibriumProblem& problem, const Eigen::VectorXd& start,
                             const EquilibriumOptions& options = {});

/// Natural shape with the middle at `middle` and tangent angle `theta` there; the usual start.
Eigen::VectorXd naturalShape(const RodModel& model, const Vec2& middle = Vec2::Zero(), double theta = 0.0);

} // namespace supercircle::rod
