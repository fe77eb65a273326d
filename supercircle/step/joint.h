#pragma once
// What holds, joins and pulls shells besides contact: plain data of the world. How each enters a step is in
// applied_forces.h (forces, mouse joints, moving targets) and link_rows.h (links).

#include "supercircle/step/port.h"

#include <compare>
#include <cstdint>
#include <limits>

namespace supercircle::step {

/// Where a target is on its way: a cubic in time between two moments, straight on before and after.
struct Path {
    bool active = false;
    double start = 0.0, end = 0.0; ///< World::time, s
    Vec2 from = Vec2::Zero(), to = Vec2::Zero();
    Vec2 fromVelocity = Vec2::Zero(), toVelocity = Vec2::Zero();
    double fromAngle = 0.0, toAngle = 0.0, fromSpin = 0.0, toSpin = 0.0;
};

/// A moving place: where it is now, how it goes on, and what it was asked to reach next.
struct Target {
    Vec2 point = Vec2::Zero();    ///< at the current time, m
    double angle = 0.0;           ///< rad
    Vec2 velocity = Vec2::Zero(); ///< m/s
    double spin = 0.0;            ///< rad/s
    Path path;                    ///< rules while it is active
    bool pending = false;         ///< `path` holds a goal (to*); the coming frame gives it its times
    [[nodiscard]] bool moving() const { return path.active || pending || !velocity.isZero(0.0) || spin != 0.0; }
};

/// Where a held point meets a body that cannot yield either (stages/stop_holds.cpp), or another one of its shell
/// (stages/hold_pairs.cpp).
struct HoldStop {
    double time = std::numeric_limits<double>::infinity(); ///< World::time at which the target comes to rest
    BodyId body = 0;                                       ///< that the point touches, 0: none
    double since = 0.0;                                    ///< World::time of the first touch, while there is a body
    bool driven = false;                                   ///< the hold went there; false: the body came
    bool byHold = false, byHoldBefore = false; ///< another hold of the shell stops it at `time`; it did before
};

/// Holds one material point of a rod: position, and direction too when `clamped`. A clamp that yields has a spring for
/// the direction (rods/hold_springs.h).
struct Hold {
    double s = 0.0;           ///< rod arc length, m
    bool clamped = true;      ///< false: pinned (position only)
    bool onCrosshead = false; ///< carried by the machine: its velocity is World::crossheadVelocity, not the target's
    Target target;            ///< where the point and its section are to be
    Vec2 reaction = Vec2::Zero(); ///< force on the rod in the last step, N
    double reactionTorque = 0.0;  ///< N m
    double maxForce = 0.0;        ///< N, beyond which it breaks; 0: never
    double turnStiffness = 0.0;   ///< torque over angle of a clamp that yields, N m; 0: it does not
    std::uint32_t key = 0;        ///< stable identity, 0: nobody asks
    HoldStop stop;
    [[nodiscard]] bool yields() const { return clamped && turnStiffness > 0.0; }
    [[nodiscard]] bool fixesAngle() const { return clamped && !yields(); }
    [[nodiscard]] int rows() const { return fixesAngle() ? 3 : 2; } ///< of the motion that it takes away
};

/// A force (and torque) that somebody else applies, constant in the world frame within a step.
struct AppliedForce {
    double s = 0.0; ///< rod arc length, m
    Vec2 force = Vec2::Zero();
    double torque = 0.0;   ///< N m
    bool once = false;     ///< ends with the coming frame
    std::uint32_t key = 0; ///< 0: nobody asks
};

/// Spring and damper between a point of the rod and a place, with a largest force. Implicit.
struct MouseJoint {
    double s = 0.0; ///< rod arc length, m
    Vec2 target = Vec2::Zero();
    double stiffness = 0.0;    ///< N/m
    double damping = 0.0;      ///< N s/m
    double maxForce = 0.0;     ///< N
    Vec2 force = Vec2::Zero(); ///< on the rod in the last step, N
    std::uint32_t key = 0;
};

enum class LinkKind : std::uint8_t {
    Pin,   ///< two points stay together
    Weld,  ///< and their sections keep their angle
    Tether ///< two points stay within a length: it only pulls
};

enum class LinkEnd : std::uint8_t { World, Body, Rod };

/// Joins a point of a rod to a point of the world, of a host body or of a rod. Solved together with contact.
struct Link {
    std::uint32_t key = 0;
    LinkKind kind = LinkKind::Pin;
    LinkEnd end = LinkEnd::World;
    bool collide = false;   ///< the two may touch each other; else their contacts are left out
    std::uint32_t rodA = 0; ///< key of the rod
    double sA = 0.0;        ///< arc length on it, m
    std::uint32_t rodB = 0; ///< key
    double sB = 0.0;        ///< m
    BodyId body = 0;
    /// The point on the other end: of a body in its own frame (origin at the centre of mass, unrotated), of a rod as an
    /// offset in the frame of its section (along the tangent, along the normal), m.
    Vec2 local = Vec2::Zero();
    Target target;             ///< the point when the other end is the world
    double angle = 0.0;        ///< weld: angle of A minus that of the other end, rad
    double length = 0.0;       ///< tether, m
    double goal = 0.0;         ///< tether: length it is reeled to, m
    double reel = 0.0;         ///< tether: rate, m/s
    Vec2 force = Vec2::Zero(); ///< on rod A in the last step, N
    double torque = 0.0;       ///< weld: on rod A's section, N m
    double maxForce = 0.0;     ///< N, beyond which it breaks; 0: never
    bool broken = false;       ///< until the end of the frame, when it is removed
};

/// A body of given motion that left a rod no room, and stands (crush.h).
struct StoppedBody {
    BodyId body = 0;                  ///< 0: all that the crosshead carries
    Vec2 velocity = Vec2::Zero();     ///< that led into the rod, m/s
    double spin = 0.0;                ///< rad/s
    double until = 0.0;               ///< World::time at which it may try again, s
    Vec2 hostVelocity = Vec2::Zero(); ///< to be given back after the host's step, m/s
    double hostSpin = 0.0;            ///< rad/s
};

/// Friction of a pair of materials, instead of the mean of the two.
struct PairFriction {
    std::uint32_t a = 0, b = 0; ///< a <= b, neither 0
    double mu = 0.0;            ///< 1
};

/// Which material a host body has.
struct BodyMaterial {
    BodyId body = 0;
    std::uint32_t material = 0;
};

/// A belt: the surface of a body, or of one of its fixtures, moves along itself.
struct SurfaceSpeed {
    BodyId body = 0;
    std::uint32_t fixture = kAllFixtures;
    double speed = 0.0; ///< m/s, along (n.y, -n.x) for the outward normal n
};

/// A rod and an outline that must not collide.
struct VetoedPair {
    std::uint32_t rod = 0; ///< key
    BodyId body = 0;
    std::uint32_t outline = 0; ///< contact::Outline::key of the piece
    auto operator<=>(const VetoedPair&) const = default;
};

} // namespace supercircle::step
