#pragma once
// A rod of nodes: stiff axial springs between neighbours, bending from the angle between neighbouring edges (a discrete
// elastic rod in the plane: M. Bergou et al., ACM Trans. Graph. 27 (2008) 63), with a memory in every joint for laws
// that need one. Nothing here is shared with the rods of arcs of the project: no curvature is a coordinate.

#include "tests/reference_simulator/effects.h"
#include "tests/reference_simulator/linear.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::oracle {

using Vec2 = Eigen::Vector2d;

enum class ClampAt { None, Middle, FirstEnd };

/// A specimen as it truly is.
struct Specimen {
    double length = 0.1, curvature = 0.0, thickness = 5e-4; ///< m, 1/m, m
    double modulus = 2e-4, linearMass = 6e-3;               ///< N m^2, kg/m
    double stretchModulus = 1.1e4;                          ///< N
    ClampAt clamp = ClampAt::None;
    bool onHead = false;
    Vec2 point = Vec2::Zero(); ///< of the clamped section at displacement 0
    double angle = 0.0;        ///< of its tangent
};

/// Where between nodes: weights of four neighbouring nodes (Catmull-Rom: the curve passes through the nodes with one
/// tangent, and is linear in them).
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

    /// Natural shape where and how the clamp holds it; none: apex at x = 0 with a level tangent, opening downwards.
    [[nodiscard]] std::vector<Vec2> naturalShape() const;
    void setAngle(double angle) { specimen_.angle = angle; }

    /// Adds forces (as gradient of energy) and their derivative at time t with a step of dt.
    void addForces(const Eigen::VectorXd& x, double t, double dt, Eigen::VectorXd& gradient,
                   LinearSystem* tangent) const;
    /// Makes the state at x that of the next step's beginning.
    void commit(const Eigen::VectorXd& x, double t, double dt);
    /// Forgets everything, at the curvature it has.
    void rest(const Eigen::VectorXd& x);
    [[nodiscard]] double elasticEnergy(const Eigen::VectorXd& x) const; ///< of the plain law, J
    [[nodiscard]] double largestChange(const Eigen::VectorXd& x) const; ///< of curvature, 1/m

private:
    struct Joint {
        int left = -1, middle = 0, right = -1; ///< nodes; -1: the clamp's tangent stands for that edge
        double length = 0.0, place = 0.0, modulus = 0.0, natural = 0.0;
        double curvature = 0.0, branchMoment = 0.0, plastic = 0.0, accumulated = 0.0; ///< memory
    };
    struct Moment {
        double value = 0.0, slope = 0.0, branch = 0.0, plastic = 0.0, accumulated = 0.0;
    };
    [[nodiscard]] double angleOf(const Joint& j, const Eigen::VectorXd& x) const;
    [[nodiscard]] Moment moment(const Joint& j, double curvature, double t, double dt) const;
    void addJoint(int left, int middle, int right, double length, double place);
    void addBending(const Joint& j, const Eigen::VectorXd& x, double t, double dt, Eigen::VectorXd& gradient,
                    LinearSystem* tangent) const;
    void addStretching(int edge, const Eigen::VectorXd& x, Eigen::VectorXd& gradient, LinearSystem* tangent) const;

    Specimen specimen_;
    Effects effects_; ///< without those of other specimens
    int base_, edges_, clamped_ = -1;
    double ds_;
    std::vector<Joint> joints_;
    std::vector<double> rest_; ///< of edges, m
};

} // namespace supercircle::oracle
