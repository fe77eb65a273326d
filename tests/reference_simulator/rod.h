#pragma once
// Nodal rod: stiff axial springs between neighbouring nodes, bending from the angle between neighbouring edges (a
// discrete elastic rod in the plane: M. Bergou et al., ACM Trans. Graph. 27 (2008) 63). Hinges between edges hold the
// state of laws with history. Unlike in the project's rods of arcs, no curvature is a coordinate.

#include "tests/reference_simulator/effects.h"
#include "tests/reference_simulator/linear_system.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::reference_simulator {

using Vec2 = Eigen::Vector2d;

enum class ClampAt { None, Middle, FirstEnd };

/// A specimen with its true parameters.
struct Specimen {
    double length = 0.1, curvature = 0.0, thickness = 5e-4; ///< m, 1/m, m
    double modulus = 2e-4, linearMass = 6e-3;               ///< N m^2, kg/m
    double stretchModulus = 1.1e4;                          ///< N
    ClampAt clamp = ClampAt::None;
    bool onCrosshead = false;
    Vec2 point = Vec2::Zero(); ///< clamped section at displacement 0, m
    double angle = 0.0;        ///< its tangent angle, rad
};

/// Position between nodes: weights of four neighbouring nodes (Catmull-Rom: a smooth curve through the nodes that is
/// linear in them).
struct Weights {
    int first = 0;
    Eigen::Vector4d value = Eigen::Vector4d::Zero(), slope = Eigen::Vector4d::Zero(), bend = Eigen::Vector4d::Zero();
};
Weights weightsAt(int edges, int edge, double t);

class NodalRod {
public:
    /// @param index of the specimen @param base number of its first node in the whole system
    NodalRod(const Specimen& specimen, const Effects& effects, int index, int base, int edges);

    [[nodiscard]] int nodes() const { return edges_ + 1; }
    [[nodiscard]] int edges() const { return edges_; }
    [[nodiscard]] int base() const { return base_; }
    [[nodiscard]] int clampedNode() const { return clamped_; } ///< in the whole system; -1: none
    [[nodiscard]] double spacing() const { return ds_; }
    [[nodiscard]] double nodeLength(int i) const { return i == 0 || i == edges_ ? 0.5 * ds_ : ds_; }
    [[nodiscard]] const Specimen& specimen() const { return specimen_; }

    /// Natural shape at the clamp. Without a clamp: apex at x = 0 with a level tangent, opening downwards.
    [[nodiscard]] std::vector<Vec2> naturalShape() const;
    void setAngle(double angle) { specimen_.angle = angle; }

    /// Adds forces (gradient of the energy) and their derivative at time t for a step of dt.
    void addForces(const Eigen::VectorXd& x, double t, double dt, Eigen::VectorXd& gradient,
                   LinearSystem* tangent) const;
    /// Makes the state at x the state at the beginning of the next step.
    void commit(const Eigen::VectorXd& x, double t, double dt);
    /// Resets the history of the material at the present curvature.
    void resetHistory(const Eigen::VectorXd& x);
    [[nodiscard]] double elasticEnergy(const Eigen::VectorXd& x) const;      ///< of linear elasticity, J
    [[nodiscard]] double maxCurvatureChange(const Eigen::VectorXd& x) const; ///< of curvature, 1/m

private:
    struct Hinge {
        int left = -1, middle = 0, right = -1; ///< nodes; -1: the tangent of the clamp replaces that edge
        double length = 0.0, place = 0.0, modulus = 0.0, natural = 0.0;
        double curvature = 0.0, branchMoment = 0.0, plastic = 0.0, accumulated = 0.0; ///< state
    };
    struct Moment {
        double value = 0.0, slope = 0.0, branch = 0.0, plastic = 0.0, accumulated = 0.0;
    };
    [[nodiscard]] double angleOf(const Hinge& j, const Eigen::VectorXd& x) const;
    [[nodiscard]] Moment moment(const Hinge& j, double curvature, double t, double dt) const;
    void addHinge(int left, int middle, int right, double length, double place);
    void addBending(const Hinge& j, const Eigen::VectorXd& x, double t, double dt, Eigen::VectorXd& gradient,
                    LinearSystem* tangent) const;
    void addStretching(int edge, const Eigen::VectorXd& x, Eigen::VectorXd& gradient, LinearSystem* tangent) const;

    Specimen specimen_;
    Effects effects_; ///< without effects of other specimens
    int base_, edges_, clamped_ = -1;
    double ds_;
    std::vector<Hinge> hinges_;
    std::vector<double> rest_; ///< of edges, m
};

} // namespace supercircle::reference_simulator
