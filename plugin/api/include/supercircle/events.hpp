#pragma once
// What happened during the last pre_step. Nothing is called back while the shells are solved: read Shells::events()
// afterwards. Every list is in the order of time, except `impulses`, which is in the order of the pairs; what falls on
// one inner step is in the order of creation of the shells (of pairs: of `a`, then of `b`, bodies first by their ids).
// The same input gives the same events, bit for bit, whatever the number of threads.

#include "definitions.hpp"
#include "handle.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace supercircle {

/// A place where a shell touches another one, itself, or a body of the host.
struct Touch {
    ShellHandle a{};         ///< of two shells the one made first
    ShellHandle b{};         ///< the other shell (equal to `a`: the shell touches itself); null: a body
    std::uint64_t body = 0;  ///< id of the host's body (bridge: Box2dPort::bodyOf), 0 when `b` is a shell
    double fraction_a = 0.0; ///< arc fraction on `a`, 0 = first end, 1 = last end
    double fraction_b = 0.0; ///< arc fraction on `b`; 0 for a body
    Point point{};           ///< between the two surfaces, m
    Point normal{};          ///< unit vector from the other one towards `a`
};

/// A pair begins to touch when a contact of it first carries force, at the place that carries most. Pairs that bounce
/// between their thicknesses' 5 % do not begin anew.
struct ContactBeginEvent {
    double time = 0.0; ///< s
    Touch at{};
    double approach_speed = 0.0; ///< along the normal just before, positive when closing, m/s
};

/// A pair no longer touches: it carries no force and has parted by 5 % of the mean thickness (a body counts as the
/// shell), or one of them is gone. `at` is where it last carried force.
struct ContactEndEvent {
    double time = 0.0; ///< s
    Touch at{};
};

/// What a pair exchanged in the frame came to more than EventSettings::impulse_threshold.
struct ImpulseEvent {
    double time = 0.0;             ///< of the strongest inner step, s
    Touch at{};                    ///< where that step's strongest contact was
    double normal_impulse = 0.0;   ///< of all contacts of the pair over the whole frame, N s
    double friction_impulse = 0.0; ///< the same of the friction's size, N s
    double peak_force = 0.0;       ///< largest normal force of the pair in one inner step, N
};

/// A shell begins to snap: within a short time its stored energy fell below everything it was in a longer time before.
/// So neither vibration nor slow unloading counts. Times and energies are measured in the shell's own units,
/// T = L^2 sqrt(lambda / B) and B / L (see EventSettings).
struct SnapBeginEvent {
    double time = 0.0; ///< when it was noticed, s
    ShellHandle shell{};
    double energy_before = 0.0; ///< lowest elastic energy of the time before, J
    double energy = 0.0;        ///< elastic energy now, J
};

/// The elastic energy of a snapping shell has found no new minimum for some time.
struct SnapEndEvent {
    double time = 0.0;  ///< s
    double begun = 0.0; ///< time of the SnapBeginEvent, s
    ShellHandle shell{};
    double energy_released = 0.0; ///< elastic energy before minus the lowest reached, J
    double kinetic_peak = 0.0;    ///< largest kinetic energy of the shell on the way, J
};

/// A shell was taken out of the motion: its numbers were not finite, or even the smallest step would have moved it
/// faster than sound in its material, curled an element up beyond all bounds or led its centre line through something
/// (shells put deep into each other do, and bodies made inside a shell). It
/// stays where it was last good, neither moves nor collides any more, and can still be asked and destroyed; teleport
/// brings it back.
struct QuarantineEvent {
    double time = 0.0; ///< end of the frame in which it happened, s
    ShellHandle shell{};
};

/// Everything of one frame.
struct FrameEvents {
    std::vector<ContactBeginEvent> contact_begin;
    std::vector<ContactEndEvent> contact_end;
    std::vector<ImpulseEvent> impulses; ///< in the order of the pairs, one each
    std::vector<SnapBeginEvent> snap_begin;
    std::vector<SnapEndEvent> snap_end;
    std::vector<QuarantineEvent> quarantined;
};

/// What counts as an event. T = L^2 sqrt(lambda / B) is 43 ms for the default shell, B / L is 2.5 mJ.
struct EventSettings {
    double impulse_threshold = std::numeric_limits<double>::infinity(); ///< N s; infinite: no impulse events
    double snap_energy = 0.02;                                          ///< least elastic energy released, in B / L, 1
    double snap_time = 0.1; ///< within this time, in T, 1; compared with six times as long a time before
};

} // namespace supercircle
