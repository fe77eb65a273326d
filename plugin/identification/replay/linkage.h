#pragma once
// Rigid bodies on revolute joints under gravity, bearing friction and air drag, in double precision: what a free scene
// does where nothing touches (private to replay/).
//
// Why not the host's engine: Box2D advances velocities and positions in two explicit steps of first order, in single
// precision, and pulls joints together afterwards. Measured on a rod of 124 mm let go at 2.3 rad (Box2D 2.4.1, 50 host
// units a metre): at 1 ms it loses 34 % of its amplitude in ten periods, at 0.1 ms 6 % and the period is 3 % off; a
// recorded one loses 20 %, and that is what is to be explained. Here the equations of motion with the joints
// as constraints, M a = F + J' r, J a = -dJ/dt v, are solved at each stage of the classical Runge-Kutta method and the
// joints are closed after each step. A step of 2 ms is good for 1e-9 of a period. Dry friction has a kink where a
// joint stops: such steps end exactly there, and the joint goes on, turns round or rests as its torques say.
//
// Sources: E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II", VII.1-2 (index reduction, projection);
// S. Goyal, A. Ruina, J. Papadopoulos, Wear 143 (1991) 307 (dry friction, sticking).

#include "supercircle/effects/model.h"
#include "supercircle/step/rigid_definition.h"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace supercircle::replay {

class Linkage {
public:
    /// `failure()` says why a world cannot be played: motors, springs, chains that move.
    Linkage(const step::RigidWorldDefinition& world, const effects::BodiesModel& extra);

    [[nodiscard]] const std::string& failure() const { return failure_; }
    [[nodiscard]] double time() const { return time_; } ///< s
    /// Advances by at most `step` (s; less where a joint stops or lets go).
    void advance(double step);

    [[nodiscard]] int find(const std::string& name) const; ///< index of a body, -1: none
    struct Pose {
        step::Vec2 origin = step::Vec2::Zero(); ///< m
        double angle = 0.0;                     ///< rad, not wrapped
        step::Vec2 velocity = step::Vec2::Zero();
        double spin = 0.0; ///< rad/s
    };
    [[nodiscard]] Pose pose(int body) const;
    /// Kinetic and potential energy, and what friction and drag have taken, J.
    [[nodiscard]] double energy() const;
    [[nodiscard]] double lostInBearings() const { return state_[lossAt()]; }
    [[nodiscard]] double lostInAir() const { return state_[lossAt() + 1]; }
    [[nodiscard]] double jointGap() const; ///< largest, m
    [[nodiscard]] double mass() const;     ///< of all moving bodies, kg
    [[nodiscard]] double reach() const;    ///< farthest corner of a moving body from its nearest joint, m
    [[nodiscard]] std::uint64_t steps() const { return steps_; }

private:
    using Vec2 = step::Vec2;
    struct Edge {
        Vec2 from, to, normal; ///< body frame, origin at the centre of mass
    };
    struct Body {
        std::string name;
        int moving = -1; ///< place among the moving ones; -1: rests
        double mass = 0.0, inertia = 0.0, inverseInertia = 0.0;
        double linearDamping = 0.0, angularDamping = 0.0, gravityScale = 1.0;
        Vec2 centre = Vec2::Zero(); ///< of mass, in the frame of the body's origin
        Vec2 place = Vec2::Zero();  ///< of the centre, where it rests
        double angle = 0.0;
        std::vector<Edge> edges;
    };
    struct Joint {
        int a = 0, b = 0;
        Vec2 onA = Vec2::Zero(), onB = Vec2::Zero(); ///< from the centres of mass
        bool weld = false;
        double refAngle = 0.0;
        int turning = 0; ///< sign of the relative spin that dry friction works against; 0: rests
    };
    /// What the equations of motion give at a state.
    struct Rates {
        Eigen::VectorXd of;      ///< the state
        Eigen::VectorXd holding; ///< of each joint: torque that holds it where it rests, N m
        Eigen::VectorXd dry;     ///< of each joint: largest dry torque, N m
    };

    void addBody(const step::BodyDefinition& d);
    void addFixture(const step::FixtureDefinition& f, Body& body, bool massKnown, double& mass, Vec2& moment,
                    double& inertia) const;
    void addJoint(const step::JointDefinition& d);
    [[nodiscard]] Eigen::Index lossAt() const { return 6 * moving_; }
    [[nodiscard]] Vec2 placeOf(const Body& b, const Eigen::VectorXd& y) const;
    [[nodiscard]] double angleOf(const Body& b, const Eigen::VectorXd& y) const;
    [[nodiscard]] double relativeSpin(const Joint& j, const Eigen::VectorXd& y) const;
    [[nodiscard]] Rates rates(const Eigen::VectorXd& y) const;
    void jacobian(const Eigen::VectorXd& y, Eigen::MatrixXd& J, Eigen::VectorXd& bias, bool withResting) const;
    void airOn(const Body& b, const Eigen::VectorXd& y, Eigen::VectorXd& force, double& power) const;
    [[nodiscard]] Eigen::VectorXd runge(double h) const;
    void close();
    void startTurning();
    void settleFriction();

    std::string failure_;
    effects::BodiesModel extra_;
    Vec2 gravity_;
    std::vector<Body> bodies_;
    std::vector<Joint> joints_;
    Eigen::Index moving_ = 0;
    Eigen::VectorXd inverseMass_; ///< 3 per moving body
    Eigen::VectorXd state_;       ///< places (x, y, angle per moving body), velocities, two losses
    double time_ = 0.0;
    std::uint64_t steps_ = 0;
};

} // namespace supercircle::replay
