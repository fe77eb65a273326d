#pragma once
// Rigid bodies as plain definitions (names follow R.U.B.E. / b2dJson), SI units: what a scene file declares and the
// bridge builds. The core itself never simulates them.

#include "supercircle/rod/arc.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::step {

using rod::Vec2;

enum class BodyType : std::uint8_t { Static, Kinematic, Dynamic };
enum class ShapeKind : std::uint8_t { Circle, Polygon, Chain, Loop };

struct FixtureDefinition {
    std::string name;
    ShapeKind shape = ShapeKind::Polygon;
    std::vector<Vec2>
        vertices; ///< m, body frame; polygon: convex, 3 to 8, counter-clockwise; chain, loop: solid on the right
    bool twoSided = false;      ///< chain of two vertices that is solid from both sides (an edge of R.U.B.E.)
    Vec2 centre = Vec2::Zero(); ///< m, circle
    double radius = 0.0;        ///< m, circle
    double density = 1.0;       ///< kg/m^2
    double friction = 0.2;      ///< 1
    double restitution = 0.0;   ///< 1
    bool sensor = false;
    std::uint16_t filterCategoryBits = 1;
    std::uint16_t filterMaskBits = 65535;
    std::int16_t filterGroupIndex = 0;
};

/// Mass data that replaces what the fixtures' densities give (`massData-*` of b2dJson).
struct MassData {
    double mass = 0.0;          ///< kg
    Vec2 centre = Vec2::Zero(); ///< m, body frame
    double inertia = 0.0;       ///< kg m^2, about the body *origin*, as Box2D has it
};

struct BodyDefinition {
    std::string name;
    BodyType type = BodyType::Static;
    Vec2 position = Vec2::Zero();       ///< m, of the body origin
    double angle = 0.0;                 ///< rad
    Vec2 linearVelocity = Vec2::Zero(); ///< m/s
    double angularVelocity = 0.0;       ///< rad/s
    double linearDamping = 0.0;         ///< 1/s
    double angularDamping = 0.0;        ///< 1/s
    double gravityScale = 1.0;
    bool bullet = false;
    bool fixedRotation = false;
    bool allowSleep = true;
    bool awake = true;
    bool active = true;
    std::vector<FixtureDefinition> fixtures;
    std::optional<MassData> massData; ///< empty: from the fixtures
};

enum class JointKind : std::uint8_t {
    Revolute,
    Prismatic,
    Distance,
    Weld,
    Wheel,
    Friction,
    Motor,
    Pulley,
    Gear,
    Mouse
};

/// A spring and a damper along the motion that a joint leaves free: angle of a revolute joint, way of a prismatic one,
/// length of a distance joint. The force is stiffness x (1 + cubic x^2) + viscosity dx/dt with x = coordinate - rest.
struct JointSpring {
    double stiffness = 0.0; ///< N/m or N m/rad
    double cubic = 0.0;     ///< 1/m^2 or 1/rad^2, of either sign
    double viscosity = 0.0; ///< N s/m or N m s/rad
    double rest = 0.0;      ///< m or rad
    [[nodiscard]] bool on() const { return stiffness != 0.0 || viscosity != 0.0; }
};

/// Dry friction against that motion.
struct JointFriction {
    double sliding = 0.0;  ///< N or N m
    double sticking = 0.0; ///< N or N m, largest at rest
};

struct JointDefinition {
    std::string name;
    JointKind kind = JointKind::Revolute;
    std::int32_t bodyA = -1; ///< index into the bodies
    std::int32_t bodyB = -1;
    Vec2 anchorA = Vec2::Zero(); ///< m, frame of A; motor: where B's origin shall be
    Vec2 anchorB = Vec2::Zero(); ///< m, frame of B; mouse: in the world
    Vec2 localAxisA = Vec2::UnitX();
    double refAngle = 0.0; ///< rad
    double length = 0.0;   ///< m, distance joint
    bool collideConnected = false;
    bool enableLimit = false;
    double lowerLimit = 0.0; ///< rad or m
    double upperLimit = 0.0;
    bool enableMotor = false;
    double motorSpeed = 0.0;           ///< rad/s or m/s
    double maxMotorForce = 0.0;        ///< N (prismatic, friction, motor, mouse) or N m (revolute, wheel)
    double maxTorque = 0.0;            ///< N m (friction, motor)
    double frequency = 0.0;            ///< Hz, soft joints
    double dampingRatio = 0.0;         ///< 1
    double correctionFactor = 0.3;     ///< 1, motor
    Vec2 groundAnchorA = Vec2::Zero(); ///< m, pulley, in the world
    Vec2 groundAnchorB = Vec2::Zero(); ///< m
    double lengthA = 0.0;              ///< m, pulley: lengthA + ratio * lengthB stays
    double lengthB = 0.0;              ///< m
    double ratio = 1.0;                ///< 1, pulley and gear
    std::int32_t joint1 = -1;          ///< gear: indices into the joints, revolute or prismatic
    std::int32_t joint2 = -1;
    Vec2 target = Vec2::Zero(); ///< m, mouse, in the world
    JointSpring spring;         ///< Box2D has none of the two: scenes with them are played by `replay`
    JointFriction friction;
};

struct RigidWorldDefinition {
    Vec2 gravity{0.0, -9.81}; ///< m/s^2
    double lengthScale = 1.0; ///< host units per metre
    std::vector<BodyDefinition> bodies;
    std::vector<JointDefinition> joints;
};

} // namespace supercircle::step
