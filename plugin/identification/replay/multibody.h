#pragma once
// Rigid bodies on revolute joints with gravity, bearing friction and air drag, without contact, in double precision
// (private to replay/).
//
// The equations of motion with constraints, M a = F + J' r, J a = -dJ/dt v, are solved at each stage of the classical
// Runge-Kutta method; joints are projected after each step. A step of 2 ms is accurate to 1e-9 of a period. Steps end
// where dry friction stops a joint. Box2D is not used, because its first-order steps in single precision lose 34 % of
// an amplitude in ten periods (decision 0023).
//
// Sources: E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", VII.1-2 (index reduction, projection);
// S. Goyal, A. Ruina, J. Papadopoulos, Wear 143 (1991) 307 (dry friction, sticking).

#include "supercircle/effects/model.h"
#include "supercircle/step/rigid_definition.h"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace supercircle::replay {

class Multibody {
public:
    /// `failure()` says why a world cannot be simulated: motors, springs, moving chains.
    Multibody(const step::RigidWorldDefinition& world, const effects::BodiesModel& extra);

    [[nodiscard]] const std::string& failure() const { return failure_; }
    [[nodiscard]] double time() const { return time_; } ///< s
    /// Advances by at most `step` s, less where a joint stops or starts.
    void advance(double step);

    [[nodiscard]] int find(const std::string& name) const; ///< index of a body, -1: none
    struct Pose {
        step::Vec2 origin = step::Vec2::Zero(); ///< m
        double angle = 0.0;                     ///< rad, not wrapped
        step::Vec2 velocity = step::Vec2::Zero();
        double spin = 0.0; ///< rad/s
    };
    [[nodiscard]] Pose pose(int body) const;
    /// Kinetic and potential energy, and the losses by friction and drag, J.
    [[nodiscard]] double energy() const;
    [[nodiscard]] double bearingLoss() const { return state_[lossIndex()]; }
    [[nodiscard]] double airLoss() const { return state_[lossIndex() + 1]; }
    [[nodiscard]] double jointGap() const; ///< m, largest
    [[nodiscard]] double mass() const;     ///< kg, of all moving bodies
    [[nodiscard]] double reach() const;    ///< m, farthest corner of a moving body from its nearest joint
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

private:
    using Vec2 = step::Vec2;
    struct Edge {
        Vec2 from, to, normal; ///< body frame, origin at the centre of mass
    };
    struct Body {
        std::string name;
        int moving = -1; ///< index among the moving bodies; -1: fixed
        double mass = 0.0, inertia = 0.0, inverseInertia = 0.0;
        double linearDamping = 0.0, angularDamping = 0.0, gravityScale = 1.0;
        Vec2 centre = Vec2::Zero();   ///< of mass, in the body frame
        Vec2 position = Vec2::Zero(); ///< of the centre, if fixed
        double angle = 0.0;
        std::vector<Edge> edges;
    };
    struct Joint {
        int a = 0, b = 0;
        Vec2 onA = Vec2::Zero(), onB = Vec2::Zero(); ///< from the centres of mass
        bool weld = false;
        double refAngle = 0.0;
        int turning = 0; ///< sign of the relative spin that dry friction opposes; 0: sticking
    };
    /// Result of the equations of motion at a state.
    struct Rates {
        Eigen::VectorXd of;            ///< time derivative of the state
        Eigen::VectorXd holdingTorque; ///< N m, of each joint: torque that keeps it sticking
        Eigen::VectorXd dryTorque;     ///< N m, of each joint: largest dry friction torque
    };

    void addBody(const step::BodyDefinition& d);
    void addFixture(const step::FixtureDefinition& f, Body& body, bool massKnown, double& mass, Vec2& moment,
                    double& inertia) const;
    void addJoint(const step::JointDefinition& d);
    [[nodiscard]] Eigen::Index lossIndex() const { return 6 * moving_; }
    [[nodiscard]] Vec2 positionOf(const Body& b, const Eigen::VectorXd& y) const;
    [[nodiscard]] double angleOf(const Body& b, const Eigen::VectorXd& y) const;
    [[nodiscard]] double relativeSpin(const Joint& j, const Eigen::VectorXd& y) const;
    [[nodiscard]] Rates rates(const Eigen::VectorXd& y) const;
    void jacobian(const Eigen::VectorXd& y, Eigen::MatrixXd& J, Eigen::VectorXd& bias, bool withResting) const;
    void airOn(const Body& b, const Eigen::VectorXd& y, Eigen::VectorXd& force, double& power) const;
    [[nodiscard]] Eigen::VectorXd rungeKuttaStep(double h) const;
    void projectJoints();
    void updateTurning();
    void updateFriction();

    std::string failure_;
    effects::BodiesModel extra_;
    Vec2 gravity_;
    std::vector<Body> bodies_;
    std::vector<Joint> joints_;
    Eigen::Index moving_ = 0;
    Eigen::VectorXd inverseMass_; ///< 3 per moving body
    Eigen::VectorXd state_;       ///< positions (x, y, angle per moving body), velocities, two losses
    double time_ = 0.0;
    std::uint64_t steps_ = 0;
};

} // namespace supercircle::replay
