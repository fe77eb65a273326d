#pragma once
// Events of the last pre_step: read Shells::events() afterwards; there are no callbacks. Lists are in the order of
// time, `impulses` in the order of the pairs. Within an inner step the order is that of creation of the shells; of
// pairs by `a`, then by `b`, with bodies first by their ids. The same input gives bitwise identical events for any
// number of threads.

#include "definitions.hpp"
#include "handle.hpp"
#include "mechanics.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace supercircle {

/// A point where a shell touches another one, itself, or a body of the host.
struct ContactPoint {
    ShellHandle a{};         ///< of two shells the one created first
    ShellHandle b{};         ///< the other shell (equal to `a`: the shell touches itself); null: a body
    std::uint64_t body = 0;  ///< id of the host's body (bridge: Box2dPort::bodyOf), 0 when `b` is a shell
    double fraction_a = 0.0; ///< arc fraction on `a`, 0 = first end, 1 = last end
    double fraction_b = 0.0; ///< arc fraction on `b`; 0 for a body
    Point point{};           ///< between the two surfaces, m
    Point normal{};          ///< unit vector from the other surface towards `a`
};

/// A pair comes into contact: one of its contact points carries force. `at` is the point with the largest force. A pair
/// that bounces within 5 % of its mean thickness stays in contact.
struct ContactBeginEvent {
    double time = 0.0; ///< s
    ContactPoint at{};
    double approach_speed = 0.0; ///< along the normal just before, positive when closing, m/s
};

/// A pair leaves contact: it carries no force and its gap exceeds 5 % of the mean thickness (of the shell, against a
/// body), or one of the two is destroyed. `at` is where it last carried force.
struct ContactEndEvent {
    double time = 0.0; ///< s
    ContactPoint at{};
};

/// The normal impulse of a pair in the frame exceeds EventSettings::impulse_threshold.
struct ImpulseEvent {
    double time = 0.0;             ///< of the inner step with the largest normal impulse, s
    ContactPoint at{};             ///< the contact point with the largest force in that step
    double normal_impulse = 0.0;   ///< of all contacts of the pair over the whole frame, N s
    double friction_impulse = 0.0; ///< sum of the magnitudes of friction, N s
    double peak_force = 0.0;       ///< largest normal force of the pair in one inner step, N
};

/// A shell begins to snap: within a short time its elastic energy falls below its minimum over a longer time before.
/// Vibration and slow unloading do not count. Times and energies are in the shell's own units, T = L^2 sqrt(lambda / B)
/// and B / L (see EventSettings).
struct SnapBeginEvent {
    double time = 0.0; ///< of the detection, s
    ShellHandle shell{};
    double energy_before = 0.0; ///< minimum of the elastic energy over the longer time before, J
    double energy = 0.0;        ///< elastic energy now, J
};

/// The elastic energy of a snapping shell has had no new minimum for some time.
struct SnapEndEvent {
    double time = 0.0;  ///< s
    double begun = 0.0; ///< time of the SnapBeginEvent, s
    ShellHandle shell{};
    double energy_released = 0.0; ///< elastic energy before minus the lowest reached, J
    double kinetic_peak = 0.0;    ///< largest kinetic energy of the shell during the snap, J
};

enum class QuarantineReason : std::uint8_t {
    NotFinite, ///< its coordinates or velocities were not finite
    Runaway,   ///< the smallest step would curl an element up to more than a circle
    Crushed    ///< given motions left it no room (CrushPolicy::Freeze)
};
/// The reason as a half sentence, such as "its numbers were not finite".
[[nodiscard]] const char* message(QuarantineReason reason);

/// A shell is taken out of the motion. It stays in its last accepted place and neither moves nor collides. It can be
/// queried and destroyed. teleport or RecoverySettings return it to the motion.
struct QuarantineEvent {
    double time = 0.0; ///< s
    ShellHandle shell{};
    QuarantineReason reason = QuarantineReason::NotFinite;
};

/// A shell crosses another one, itself or a body without having moved there: it was created, teleported or restored
/// there, or the body was. The two have no contact and are pushed apart at 20 thicknesses a second at most, along the
/// shortest way, off an end or out of a solid. Contact returns when they are free. Shells::fits asks beforehand.
struct OverlapEvent {
    double time = 0.0;      ///< end of the frame in which it was found, s
    ShellHandle a{};        ///< of two shells the one created first
    ShellHandle b{};        ///< the other shell (equal to `a`: the shell crosses itself); null: a body
    std::uint64_t body = 0; ///< id of the host's body, 0 when `b` is a shell
};

/// Given motions leave a shell no room: a kinematic body presses it against something that does not yield, or a hold is
/// driven into a body. No motion of the shell satisfies them. Shells::set_crush_policy says how it ends. The event
/// comes again whenever a body that stood for it tries to go on in vain.
struct CrushedEvent {
    double time = 0.0; ///< s
    ShellHandle shell{};
    std::uint64_t body = 0; ///< id of the host's body that presses, or that the hold is driven into
    HoldHandle hold{};      ///< the driven hold, which stops; null: the body moves
};

/// A hold or joint was asked for more than its largest force (Shells::set_max_force). It is destroyed.
struct BrokeEvent {
    double time = 0.0;   ///< s
    ShellHandle shell{}; ///< the (first) shell
    HoldHandle hold{};   ///< stale; null: a joint
    JointHandle joint{}; ///< stale; null: a hold
    Point force{};       ///< on the shell in the last step, N
};

/// A held point meets a static or kinematic body. Neither can yield, so the hold stops there: its target stays where
/// the shell's surface touches, at rest, until it is given another one that leads away or along. A body that comes to a
/// held point is reported only: the hold stays where it is, and the body goes on. The event comes once, until the two
/// are apart by 5 % of the thickness. Two holds of one shell stop each other, without a body: where the shell between
/// them is drawn nearly straight, or where they would meet.
struct HoldBlockedEvent {
    double time = 0.0; ///< of the first touch, s
    ShellHandle shell{};
    HoldHandle hold{};
    BodyId body = 0;      ///< 0: another hold of the shell
    bool stopped = false; ///< the target came to rest; false: the body came
};

/// All events of one frame.
struct FrameEvents {
    std::vector<ContactBeginEvent> contact_begin;
    std::vector<ContactEndEvent> contact_end;
    std::vector<ImpulseEvent> impulses; ///< at most one a pair
    std::vector<SnapBeginEvent> snap_begin;
    std::vector<SnapEndEvent> snap_end;
    std::vector<QuarantineEvent> quarantined;
    std::vector<CrushedEvent> crushed;
    std::vector<BrokeEvent> broke;
    std::vector<OverlapEvent> overlapping; ///< in the order of the pairs
    std::vector<HoldBlockedEvent> hold_blocked;
};

/// Thresholds of events. T = L^2 sqrt(lambda / B) is 43 ms for the default shell, B / L is 2.5 mJ.
struct EventSettings {
    double impulse_threshold = std::numeric_limits<double>::infinity(); ///< N s; infinite: no impulse events
    double snap_energy = 0.04;                                          ///< least elastic energy released, in B / L, 1
    double snap_time = 0.1; ///< the short time, in T, 1; the longer time before is six times as long
};

} // namespace supercircle
