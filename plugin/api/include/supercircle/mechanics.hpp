#pragma once
// What holds, joins and pulls shells: definitions in, handles out. SI units throughout.
//
// A part (hold, joint, grab, force) lives as long as its shells and host bodies: it goes with the first of them, and
// its handle is stale from then on. All of them act in the contact problem itself or in the same implicit step, not
// between the steps, and are exact as long as the step converges: a clamp is where it is driven, a joint's drift is
// corrected in the next step, a tether is never longer than its length by more than about 1e-7 of it.

#include "definitions.hpp"
#include "handle.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace supercircle {

/// Names a part of a world of shells; stale and foreign ones give errors, never crashes. Zero is nobody.
template <class Kind>
struct PartHandle {
    std::uint32_t index = 0;      ///< of its shell, 0 for joints
    std::uint32_t generation = 0; ///< counts all parts of a world: never given twice
    std::uint32_t world = 0;      ///< which Shells it belongs to
    [[nodiscard]] bool null() const { return generation == 0; }
    friend bool operator==(const PartHandle&, const PartHandle&) = default;
};

using HoldHandle = PartHandle<struct HoldPart>;   ///< a clamp or a pin, on the ground or moving
using JointHandle = PartHandle<struct JointPart>; ///< a pin, weld or tether to a body, a shell or a place
using GrabHandle = PartHandle<struct GrabPart>;   ///< a soft hand (mouse)
using ForceHandle = PartHandle<struct ForcePart>; ///< a force that lasts

/// Names a body of the host; Shells::body finds it by name, the host's bridge by its own object. 0 is nobody.
using BodyId = std::uint64_t;

/// What a hold, joint or grab does to its (first) shell, mean over the last inner step.
struct Reaction {
    Point force{};       ///< N
    double torque = 0.0; ///< on the shell's section at that point, N m; clamps and welds only
};

/// Where a held point shall be at the end of the coming frame, and how it goes on from there. Within the frame it goes
/// along a cubic that begins with its present velocity, so that a target sampled frame by frame from a smooth motion is
/// followed without jerks; afterwards straight on until it is driven anew.
struct DriveDef {
    Point position{};   ///< m
    double angle = 0.0; ///< of the tangent, rad, not modulo 2 pi: start from Shells::target; clamps only
    Point velocity{};   ///< at and after the end of the frame, m/s
    double spin = 0.0;  ///< rad/s; clamps only
};

enum class JointKind : std::uint8_t {
    Pin,   ///< the two points stay together, free to turn
    Weld,  ///< and their sections keep their angle
    Tether ///< an inextensible string between the two points: pulls, never pushes
};

/// Joins a point of a shell to a point of something else as both are *now*: nothing moves by making a joint.
struct JointDef {
    JointKind kind = JointKind::Weld;
    ShellHandle shell{};
    double arc_fraction = 0.5; ///< place on the shell, 0 = first end, 1 = last end
    // The other end is one of these three.
    ShellHandle other{};         ///< a shell (or the same one), if not null
    double other_fraction = 0.5; ///< place on it
    BodyId body = 0;             ///< a body of the host, if not 0
    /// Tethers to a body: where on it the string is tied, as a point of the world now, m. Tethers to neither shell nor
    /// body: the place in the world, which can be driven. Pins and welds need none: they join what is at the shell's
    /// point.
    Point point{};
    double length = 0.0;            ///< of a tether, m; 0: the present distance. Not shorter than that: reel it in
    bool collide_connected = false; ///< whether the two may touch each other elsewhere (and a tethered pair at all)
};

/// A soft hand that pulls a point of a shell to a place: spring and damper, implicit, hence stable however stiff.
struct GrabDef {
    double arc_fraction = 0.5;
    Point target{};             ///< m
    double frequency = 5.0;     ///< of the whole shell's mass on that spring, Hz
    double damping_ratio = 0.7; ///< 1: critical for the whole shell's mass
    double max_force = 0.0;     ///< N; 0: mass of the shell times 1000 m/s^2, as Box2D's mouse has it
};

/// What of a shell's material changes; what is not set stays. Shape and motion stay; energy that comes or goes with the
/// change is booked as `added`.
struct MaterialDef {
    std::optional<double> mu;                             ///< friction coefficient, 1
    std::optional<double> young_modulus;                  ///< Pa
    std::optional<double> density;                        ///< kg/m^3
    std::optional<std::vector<double>> natural_curvature; ///< 1/m, one for all elements or one each
};

/// Who collides with whom, as in Box2D: of two things of the same group other than 0 a positive group always collides
/// and a negative never; else each one's mask must contain the other's category. A shell and itself: category and mask.
struct FilterDef {
    std::uint16_t category = 1;
    std::uint16_t mask = 0xffff;
    std::int16_t group = 0;
};

/// When shells at rest fall asleep. Off by default: in a pile that is being dropped the impacts wake everything again
/// and again, which costs more than it saves; in a level full of things at rest it is worth switching on.
struct SleepSettings {
    bool automatic = false;
    double drift = 0.1; ///< no tip or middle of an island may have come farther than so many thicknesses (of the
                        ///< thinnest shell) from where it was
    double delay = 0.5; ///< so many seconds ago
};

} // namespace supercircle
