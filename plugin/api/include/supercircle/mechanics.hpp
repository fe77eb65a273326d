#pragma once
// Holds, joints, mouse joints and forces: definitions in, handles out, SI units.
//
// These constraints belong to their shells and host bodies. When one of those is destroyed, the constraint is destroyed
// too and its handle is stale. All of them are solved implicitly inside the step, holds and joints together with
// contact. A driven clamp reaches its target, the drift of a joint is corrected in the next step, and a tether exceeds
// its length by at most 1e-7 of it, as long as the step converges.

#include "definitions.hpp"
#include "handle.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace supercircle {

/// Names a constraint of a world of shells. A stale or foreign handle gives an error, never a crash. The default is
/// null.
template <class Kind>
struct ConstraintHandle {
    std::uint32_t index = 0;      ///< of its shell, 0 for joints
    std::uint32_t generation = 0; ///< counts all constraints of a world: never given twice
    std::uint32_t world = 0;      ///< which Shells it belongs to
    [[nodiscard]] bool null() const { return generation == 0; }
    friend bool operator==(const ConstraintHandle&, const ConstraintHandle&) = default;
};

using HoldHandle = ConstraintHandle<struct HoldTag>;             ///< a clamp or a pin
using JointHandle = ConstraintHandle<struct JointTag>;           ///< a pin, weld or tether to a body, shell or point
using MouseJointHandle = ConstraintHandle<struct MouseJointTag>; ///< a soft spring to a target, for a mouse
using ForceHandle = ConstraintHandle<struct ForceTag>;           ///< a force that lasts

/// Names a body of the host: Shells::body finds it by name, the bridge by the host's own object. 0: none.
using BodyId = std::uint64_t;

/// Stands for every fixture of a body.
inline constexpr std::uint32_t all_fixtures = 0xffffffffU;

/// A shell and a fixture of a host body that may meet (Shells::set_pair_filter).
struct PairQuery {
    ShellHandle shell;
    BodyId body = 0;
    std::uint32_t fixture = 0; ///< its number on the body, 0 for the oldest; bridge::Attachment::fixture finds it
};

/// What a hold, joint or mouse joint does to its (first) shell, mean over the last inner step.
struct Reaction {
    Point force{};       ///< N
    double torque = 0.0; ///< on the shell's section at that point, N m; clamps and welds only
};

/// Target of a held point at the end of the coming frame, and its velocity from then on. A frame shorter than 1/64 of
/// the longest step goes its share of the way, and the next ones the rest. Within the frame the point follows a cubic
/// that begins with its present velocity. Targets sampled frame by frame from a smooth motion therefore give a smooth
/// motion. Without a new target the point goes on straight. It stops where it meets a static or kinematic body
/// (FrameEvents::hold_blocked).
struct TargetDef {
    Point position{};   ///< m
    double angle = 0.0; ///< of the tangent, rad, not modulo 2 pi: start from Shells::target; clamps only
    Point velocity{};   ///< at and after the end of the frame, m/s
    double spin = 0.0;  ///< rad/s; clamps only
};

enum class JointKind : std::uint8_t {
    Pin,   ///< the two points coincide, the angle is free
    Weld,  ///< the two points coincide and the angle between their sections is fixed
    Tether ///< an inextensible string between the two points: pulls, never pushes
};

/// Joins a point of a shell to a point of something else in their present positions: making a joint moves nothing.
struct JointDef {
    JointKind kind = JointKind::Weld;
    ShellHandle shell{};
    double arc_fraction = 0.5; ///< place on the shell, 0 = first end, 1 = last end
    // The other end is one of these three.
    ShellHandle other{};         ///< a shell (or the same one), if not null
    double other_fraction = 0.5; ///< place on it
    BodyId body = 0;             ///< a body of the host, if not 0
    /// Present world position of the other end of a tether, m: on `body`, or in the world if there is neither shell nor
    /// body. Such a tether to the world has a target. Pins and welds ignore it: they join at the shell's point.
    Point point{};
    double length = 0.0;            ///< of a tether, m; 0: the present distance, which is also the least
    bool collide_connected = false; ///< whether the two collide with each other (a tethered pair always does)
};

/// Soft spring that pulls a point of a shell to a target, for a mouse: spring and damper, implicit, hence always
/// stable.
struct MouseJointDef {
    double arc_fraction = 0.5;
    Point target{};             ///< m
    double frequency = 5.0;     ///< of the whole shell's mass on that spring, Hz
    double damping_ratio = 0.7; ///< 1: critical for the whole shell's mass
    double max_force = 0.0;     ///< N; 0: mass of the shell times 1000 m/s^2, as Box2D's mouse joint has it
};

/// Changes of a shell's material; what is not set stays. Shape and motion stay. The change of energy is recorded as
/// EnergyBalance::added.
struct MaterialDef {
    std::optional<double> mu;                             ///< friction coefficient, 1
    std::optional<double> young_modulus;                  ///< Pa
    std::optional<double> density;                        ///< kg/m^3
    std::optional<std::vector<double>> natural_curvature; ///< 1/m, one for all elements or one each
    std::optional<double> damping_ratio{};                ///< as ShellDef::damping_ratio, 1
};

/// Collision filter as in Box2D. Two members of the same group other than 0 always collide (positive group) or never
/// (negative group). Otherwise each one's mask must contain the other's category. A shell against itself: category and
/// mask.
struct FilterDef {
    std::uint16_t category = 1;
    std::uint16_t mask = 0xffff;
    std::int16_t group = 0;
};

/// When shells at rest fall asleep, with the bodies on them. Off by default: while a pile is being dropped the impacts
/// wake it again and again, which costs more than sleep saves. Switch it on for levels in which most things rest.
struct SleepSettings {
    bool automatic = false;
    double drift = 0.1; ///< largest displacement of any tip, middle or body of the island within `delay`, in
                        ///< thicknesses of its thinnest shell, 1
    double delay = 0.5; ///< s
};

/// What becomes of a quarantined shell (QuarantineEvent).
enum class Recovery : std::uint8_t {
    Stay,   ///< it stays where it is until it is teleported or destroyed: the default
    Release ///< after a time it moves again, from rest in its last accepted shape and place
};

struct RecoverySettings {
    Recovery policy = Recovery::Stay;
    double after = 1.0; ///< s of simulated time in quarantine, of Recovery::Release
};

} // namespace supercircle
