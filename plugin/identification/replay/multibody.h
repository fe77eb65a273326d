#pragma once
// Rigid bodies on joints with springs, dry friction, gravity and air drag, without contact, in double precision
// (private to replay/). One of the bodies may be moved by the testing machine, others at constant velocity.
//
// The equations of motion with constraints, M a = F + J' r, J a = -dJ/dt v, are solved at each stage of the classical
// Runge-Kutta method; joints are projected after each step. A step of 2 ms is accurate to 1e-9 of a period of 0.6 s.
// Steps end where dry friction stops a joint or lets it go, and where the drive changes its speed. Box2D is not used,
// because its first-order steps in single precision lose 34 % of an amplitude in ten periods (decision 0023).
//
// Sources: E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", VII.1-2 (index reduction, projection);
// S. Goyal, A. Ruina, J. Papadopoulos, Wear 143 (1991) 307 (dry friction, sticking).

#include "supercircle/effects/model.h"
#include "supercircle/effects/surface.h"
#include "supercircle/step/rigid_definition.h"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace supercircle::replay {

class Multibody {
public:
    /// `failure()` says why a world cannot be simulated: motors, limits, chains of other joints.
    /// @param friction how dry friction of the joints depends on its state
    Multibody(const step::RigidWorldDefinition& world, const effects::BodiesModel& extra,
              const effects::FrictionModel& friction = {});

    /// The machine moves kinematic body `body` along the unit vector `direction`: `displacement` (m) at `time` (s,
    /// increasing, two at least), linear between them and beyond.
    void drive(int body, const step::Vec2& direction, std::vector<double> time, std::vector<double> displacement);

    [[nodiscard]] const std::string& failure() const { return failure_; }
    [[nodiscard]] double time() const { return time_; } ///< s
    /// Advances by at most `step` s, less where a joint stops or starts and where the drive changes its speed.
    void advance(double step);
    /// Shortest time constant of springs and dampers at the present state, s; infinite without any.
    [[nodiscard]] double shortestTime() const;

    [[nodiscard]] int find(const std::string& name) const; ///< index of a body, -1: none
    struct Pose {
        step::Vec2 origin = step::Vec2::Zero(); ///< m
        double angle = 0.0;                     ///< rad, not wrapped
        step::Vec2 velocity = step::Vec2::Zero();
        double spin = 0.0; ///< rad/s
    };
    [[nodiscard]] Pose pose(int body) const;
    /// What follows from the present forces.
    struct Forces {
        step::Vec2 acceleration = step::Vec2::Zero(); ///< of the body's origin, m/s^2
        double angularAcceleration = 0.0;             ///< rad/s^2
        double machine = 0.0; ///< N, by which the driven body is held back along its direction, without its inertia
    };
    [[nodiscard]] Forces forces(int body) const;
    /// Travel of the machine, m.
    [[nodiscard]] double travel() const;
    /// Kinetic and potential energy, and the losses by friction and drag, J.
    [[nodiscard]] double energy() const;
    [[nodiscard]] double jointLoss() const { return state_[lossIndex()]; }
    [[nodiscard]] double airLoss() const { return state_[lossIndex() + 1]; }
    [[nodiscard]] double jointGap() const; ///< m, largest
    [[nodiscard]] double mass() const;     ///< kg, of all moving bodies
    /// Farthest corner of a moving body from its nearest joint, m; 0: none has a shape.
    [[nodiscard]] double reach() const;
    /// How far springs are from rest now, and their largest force (N) and torque (N m).
    struct Elongations {
        double length = 0.0, angle = 0.0; ///< m, rad
        double force = 0.0, torque = 0.0;
    };
    [[nodiscard]] Elongations elongations() const;
    /// Fastest rate of the springs alone, rad/s.
    [[nodiscard]] double stiffness() const;
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

private:
    using Vec2 = step::Vec2;
    struct Edge {
        Vec2 from, to, normal; ///< body frame, origin at the centre of mass
    };
    struct Body {
        std::string name;
        int moving = -1; ///< index among the moving bodies; -1: its motion is given
        double mass = 0.0, inertia = 0.0, inverseInertia = 0.0;
        double linearDamping = 0.0, angularDamping = 0.0, gravityScale = 1.0;
        Vec2 centre = Vec2::Zero();   ///< of mass, in the body frame
        Vec2 position = Vec2::Zero(); ///< of the centre at time 0, if its motion is given
        double angle = 0.0;
        Vec2 velocity = Vec2::Zero(); ///< given, m/s
        double spin = 0.0;            ///< given, rad/s
        std::vector<Edge> edges;
    };
    struct Joint {
        step::JointKind kind = step::JointKind::Revolute;
        int a = 0, b = 0;
        Vec2 onA = Vec2::Zero(), onB = Vec2::Zero(); ///< from the centres of mass
        Vec2 axis = Vec2::UnitX();                   ///< in A
        double refAngle = 0.0, length = 0.0;
        step::JointSpring spring;
        double sliding = 0.0, sticking = 0.0; ///< dry friction, N or N m
        bool springs = false;                 ///< a distance joint that is a spring
        int turning = 0;                      ///< sign of the relative motion that dry friction opposes; 0: sticking
        effects::Site site;
        double held = -1.0; ///< factor of its friction in this step, solved for its end; negative: that of its rate
        /// Whether its friction is stated: a contact, not a guide.
        [[nodiscard]] bool own() const { return sticking > 0.0; }
        [[nodiscard]] bool free() const {
            return kind == step::JointKind::Revolute || kind == step::JointKind::Prismatic;
        }
    };
    /// A row of a Jacobian: rates of x, y and angle of both bodies.
    struct Row {
        Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = Eigen::Vector3d::Zero();
        double bias = 0.0; ///< rate of the row times velocities
    };
    /// The motion that a joint leaves free: angle, way along the axis, or length.
    struct Coordinate {
        Row row;
        double value = 0.0, rate = 0.0;
    };
    struct Motion {
        Vec2 position, velocity; ///< of the centre of mass
        double angle = 0.0, spin = 0.0;
    };
    struct Rows {
        Eigen::MatrixXd J;      ///< of the moving bodies
        Eigen::MatrixXd driven; ///< of the driven body, 3 columns
        Eigen::VectorXd bias;   ///< dJ/dt v of all bodies
        Eigen::VectorXd given;  ///< J v of the bodies whose motion is given
    };
    /// Result of the equations of motion at a state.
    struct Rates {
        Eigen::VectorXd of;      ///< time derivative of the state
        Eigen::VectorXd holding; ///< of each joint: force or torque that keeps it sticking, N or N m
        Eigen::VectorXd dry;     ///< of each joint: dry friction, at rest the largest, N or N m
        Eigen::Vector3d onDriven = Eigen::Vector3d::Zero(); ///< force and torque of the joints on the driven body
    };

    void addBody(const step::BodyDefinition& d);
    void addFixture(const step::FixtureDefinition& f, Body& body, bool massKnown, double& mass, Vec2& moment,
                    double& inertia) const;
    void addJoint(const step::JointDefinition& d);
    [[nodiscard]] Eigen::Index lossIndex() const { return 6 * moving_; }
    [[nodiscard]] Eigen::Index timeIndex() const { return 6 * moving_ + 2; }
    [[nodiscard]] Motion motionOf(const Body& b, const Eigen::VectorXd& y) const;
    [[nodiscard]] Motion motionOf(int body, const Eigen::VectorXd& y) const {
        return motionOf(bodies_[static_cast<std::size_t>(body)], y);
    }
    [[nodiscard]] bool hasDryFriction(const Joint& j) const;
    [[nodiscard]] bool anyDryFriction() const;
    [[nodiscard]] std::size_t rowsOf(const Joint& j) const; ///< without that of a sticking joint
    [[nodiscard]] Row along(const Joint& j, const Vec2& inA, const Eigen::VectorXd& y) const;
    [[nodiscard]] Row turn() const;
    [[nodiscard]] Coordinate coordinate(const Joint& j, const Eigen::VectorXd& y) const;
    [[nodiscard]] double relativeRate(const Joint& j, const Eigen::VectorXd& y) const;
    [[nodiscard]] Eigen::VectorXd gapsOf(const Joint& j, const Eigen::VectorXd& y) const;
    void write(const Joint& j, const Row& row, Eigen::Index at, const Eigen::VectorXd& y, Rows& rows) const;
    [[nodiscard]] Rows rowsAt(const Eigen::VectorXd& y, bool withResting) const;
    [[nodiscard]] double mobility(const Coordinate& c, const Joint& j) const;
    [[nodiscard]] double cubicOf(const Joint& j) const;
    [[nodiscard]] double viscosityOf(const Joint& j, double rate) const;
    void apply(const Joint& j, const Row& row, double force, Eigen::VectorXd& on, Eigen::Vector3d& driven) const;
    [[nodiscard]] double dryFriction(const Joint& j, double reaction, double rate, double since) const;
    [[nodiscard]] Rates rates(const Eigen::VectorXd& y) const;
    void airOn(const Body& b, const Eigen::VectorXd& y, Eigen::VectorXd& force, double& power) const;
    [[nodiscard]] Eigen::VectorXd rungeKuttaStep(double h) const;
    void holdStiffFriction(double h);
    void projectJoints(bool withResting);
    void updateTurning();
    void updateFriction();
    [[nodiscard]] bool slips(std::size_t joint, const Eigen::VectorXd& y) const;
    /// Shortens a step to the first event. @return the joint that stops or slips, nullptr: none
    Joint* firstEvent(double& h, Eigen::VectorXd& next);

    std::string failure_;
    effects::BodiesModel extra_;
    effects::FrictionModel friction_;
    Vec2 gravity_;
    std::vector<Body> bodies_;
    std::vector<Joint> joints_;
    Eigen::Index moving_ = 0;
    Eigen::VectorXd inverseMass_; ///< 3 per moving body
    Eigen::VectorXd state_;       ///< positions (x, y, angle per moving body), velocities, two losses, time
    int driven_ = -1;             ///< body
    Vec2 direction_ = Vec2::Zero();
    std::vector<double> driveTime_, driveDisplacement_;
    std::size_t segment_ = 1; ///< of the drive, by its end
    double time_ = 0.0;
    std::uint64_t steps_ = 0;
};

} // namespace supercircle::replay
