#pragma once
// Flexible shells in your rigid world:
//
//     auto shells = supercircle::Shells(bridge::attach(world, {.units_per_metre = 52.1}));
//     auto shell  = shells.create(ShellDef{});
//     shells.pre_step(dt);  world.Step(dt, 8, 3);  shells.post_step();      // you keep calling world.Step
//
// SI units. Bad input gives a failed Result and changes nothing; std::bad_alloc is the only exception. Any number of
// Shells may exist, each used by one thread at a time. Shells that were moved from have no shells and fail every call.
// During pre_step (in its observer, or in a host that is queried) shells may be read, but calls that change them fail
// with kWorldLocked. Between pre_step and post_step everything is allowed, also in callbacks of the host's own step.

#include "definitions.hpp"
#include "deprecated.hpp"
#include "draw.hpp"
#include "effects.hpp"
#include "events.hpp"
#include "handle.hpp"
#include "mechanics.hpp"
#include "queries.hpp"
#include "snapshot.hpp"

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace supercircle {

namespace step {
class Port;
struct World;
struct Settings;
class Stepper;
} // namespace step

/// Accuracy against computing time. Both qualities obey the same laws: inextensible shells, exact Coulomb friction, no
/// crossing.
enum class Quality : std::uint8_t {
    Laboratory, ///< the default: step sizes follow from the accuracy of forces and energies
    Game ///< steps up to a frame of 1/60 s and a budget of work per frame (docs/how-to/game_quality_and_frame_budget.md
         ///< lists the errors)
};

/// What becomes of a shell that given motions leave no room (CrushedEvent). A game that wants it destroyed does so on
/// the event.
enum class CrushPolicy : std::uint8_t {
    Wait, ///< steps get shorter and shorter, in Quality::Game the frames slower; the default of Quality::Laboratory
    /// The frame ends early, and the body stands for 0.25 s or until it turns back: a kinematic body gets its velocity
    /// back in post_step, one that was put forward is put back. A driven hold stops. The default of Quality::Game.
    Stop,
    Freeze ///< the shell is quarantined (FrameEvents::quarantined); a driven hold stops
};

/// What one frame did.
struct FrameReport {
    double advanced = 0.0; ///< s; less than dt when stopped, out of budget or failed, or when a shell was crushed
    union {
        bool budget_exhausted = false; ///< Quality::Game: the budget of the frame was used up, the rest of dt left out
        [[deprecated("use budget_exhausted")]] bool late;
    };
    bool stopped = false;   ///< the observer asked to stop, or threw (then `failure` has its message)
    bool bad_input = false; ///< dt is at fault, as `failure` says, and nothing moved
    std::string failure;    ///< empty unless the shells could not go on
    /// Bodies and gravity of the host that this frame left out, because their numbers are not finite; empty: none.
    std::string refused;
    /// What shells do not take from the host, such as restitution; each message comes once for a host world.
    std::string note;
    /// Shells that are quarantined at the end of the frame: since when and why. In the order of creation.
    std::vector<QuarantineEvent> quarantined;
    /// One line on a frame that ended early, was made in many attempts or lost a shell: why, and what closing gaps
    /// injected. Empty: there is nothing to say.
    std::string why;
    double work = 0.0;     ///< that the frame took, in units of set_frame_budget
    double injected = 0.0; ///< by closing gaps in this frame, J (EnergyBalance::injected)
    /// Alarm: energy that islands ended the frame with and that nobody gave, J; 0 up to a thousandth of what moves and
    /// what closing gaps may bring in. It says that positions are forced: look for what pushes things into each other.
    double energy_gained = 0.0;
    std::uint64_t steps = 0;       ///< of all islands together; sleeping ones take none
    std::uint64_t unconverged = 0; ///< steps whose contact residual stayed above tolerance
};

/// Energies since creation, J (see docs/architecture.md):
/// (kinetic + bending + gravity) - added = work - (friction + impact + numerical + ...) + residual.
struct EnergyBalance {
    double kinetic = 0.0;   ///< of the shells now
    double bending = 0.0;   ///< elastic, of the shells now
    double gravity = 0.0;   ///< potential, of the shells now
    double added = 0.0;     ///< by creating, destroying, moving and changing shells
    double work = 0.0;      ///< done on the shells by holds, joints, forces and driven bodies
    double friction = 0.0;  ///< dissipated
    double impact = 0.0;    ///< dissipated
    double numerical = 0.0; ///< dissipated by the time integration
    union {
        double position_correction = 0.0; ///< added by correcting penetrations and gaps of joints
        [[deprecated("use position_correction")]] double push_out;
    };
    double injected = 0.0;  ///< part of position_correction that closing gaps brought in; grows only
    double effects = 0.0;   ///< dissipated by effects
    double damping = 0.0;   ///< dissipated by ShellDef::damping_ratio
    double to_bodies = 0.0; ///< passed to dynamic bodies of the host
    double residual = 0.0;  ///< what the terms above leave unexplained; rounding
};

/// Position and shape of a shell.
struct ShellPose {
    Point start{};                 ///< first end, m
    double angle = 0.0;            ///< tangent angle there, rad
    std::vector<double> curvature; ///< per element, 1/m
    double bending_energy = 0.0;   ///< J
};

class Shells : public OldNames<Shells> {
public:
    /// `port` is the host world (bridge::attach); null: shells alone, without gravity and walls.
    explicit Shells(std::shared_ptr<step::Port> port);
    ~Shells();
    Shells(Shells&&) noexcept;
    Shells& operator=(Shells&&) noexcept;

    /// Selects the settings of the numerics, at any time. Settings made through stepper() are replaced.
    Status set_quality(Quality quality);
    [[nodiscard]] Quality quality() const;
    /// Quality::Game: work per frame, in units of about 1 us of one core; 0: no limit. The default is 8333, half a
    /// frame of 60 Hz. Above half of it steps get longer. When it is used up the frame ends early
    /// (FrameReport::budget_exhausted), after 1.5 budgets and one contact problem at most. set_quality resets it. Fails
    /// in Quality::Laboratory.
    Status set_frame_budget(std::uint64_t work);
    /// What becomes of crushed shells. set_quality resets it.
    Status set_crush_policy(CrushPolicy policy);
    /// Threads that pre_step may use, 1 to 256. The results do not depend on it.
    Status set_threads(int threads);

    /// Adds a shell. Fails with a reason on bad numbers.
    Result<ShellHandle> create(const ShellDef& definition);
    /// Whether a shell of this definition fits here: its centre line crosses no shell, no body and not itself, and no
    /// part of it lies in a solid, as far as its filter lets them collide. Fails with a reason on bad numbers.
    [[nodiscard]] Result<bool> fits(const ShellDef& definition) const;
    /// Removes a shell with its holds, joints, mouse joints and forces. Fails if the handle is stale.
    Status destroy(ShellHandle shell);
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] bool valid(ShellHandle shell) const;

    // ---- Mechanics: mechanics.hpp. Places on a shell are arc fractions, 0 = first end, 1 = last end. ----

    /// Holds the point at `arc_fraction` where it is now.
    Result<HoldHandle> create_hold(ShellHandle shell, double arc_fraction, HoldKind kind,
                                   HoldBase base = HoldBase::Fixed);
    Result<HoldHandle> create_clamp(ShellHandle shell, double arc_fraction) {
        return create_hold(shell, arc_fraction, HoldKind::Clamp);
    }
    Result<HoldHandle> create_pin(ShellHandle shell, double arc_fraction) {
        return create_hold(shell, arc_fraction, HoldKind::Pin);
    }
    /// Target of the held point at the end of the coming frame; HoldBase::Fixed only.
    Status set_target(HoldHandle hold, const TargetDef& target);
    /// The present target and its velocity: what to start a TargetDef from.
    [[nodiscard]] Result<TargetDef> target(HoldHandle hold) const;
    [[nodiscard]] Result<Reaction> reaction(HoldHandle hold) const;
    /// Largest force, N; 0, the default: any. A hold or joint that needed more in an inner step is destroyed after it
    /// (BrokeEvent). Fails unless it is finite and not negative.
    Status set_max_force(HoldHandle hold, double force);
    Status set_max_force(JointHandle joint, double force);
    Status destroy(HoldHandle hold);

    Result<JointHandle> create_joint(const JointDef& definition);
    /// Target of the point a tether is tied to; tethers to the world only. Angle and spin are ignored.
    Status set_target(JointHandle joint, const TargetDef& target);
    [[nodiscard]] Result<TargetDef> target(JointHandle joint) const;
    /// Makes a tether longer or shorter at `rate` (m/s, positive) until it has `length` (m, positive).
    Status set_max_length(JointHandle joint, double length, double rate);
    [[nodiscard]] Result<double> length(JointHandle joint) const; ///< of a tether now, m
    [[nodiscard]] Result<Reaction> reaction(JointHandle joint) const;
    Status destroy(JointHandle joint);

    Result<MouseJointHandle> create_mouse_joint(ShellHandle shell, const MouseJointDef& definition);
    Status set_target(MouseJointHandle joint, Point target); ///< m
    [[nodiscard]] Result<Reaction> reaction(MouseJointHandle joint) const;
    Status destroy(MouseJointHandle joint);

    /// Force (N) and torque (N m) during the coming pre_step; several add up.
    Status apply_force(ShellHandle shell, double arc_fraction, Point force, double torque = 0.0);
    Status apply_torque(ShellHandle shell, double arc_fraction, double torque);
    /// Changes the velocities at once by an impulse (N s) and an angular impulse (N m s).
    Status apply_impulse(ShellHandle shell, double arc_fraction, Point impulse, double angular_impulse = 0.0);
    /// A force (N) and torque (N m) that last until they are changed or destroyed.
    Result<ForceHandle> create_force(ShellHandle shell, double arc_fraction, Point force, double torque = 0.0);
    Status set_force(ForceHandle handle, Point force, double torque = 0.0);
    Status destroy(ForceHandle handle);

    [[nodiscard]] bool valid(HoldHandle handle) const;
    [[nodiscard]] bool valid(JointHandle handle) const;
    [[nodiscard]] bool valid(MouseJointHandle handle) const;
    [[nodiscard]] bool valid(ForceHandle handle) const;

    // ---- Effects: effects.hpp, docs/reference/effects.md. ----

    /// Switches an effect of material, load or contact on, or gives it other values. Without a switch among the
    /// parameters, as in an empty list, its switches have their default values, otherwise those not given are neutral.
    /// An effect whose switches are all neutral is removed. Slots whose effects change start at rest (no plastic
    /// curvature, no relaxed stress, no wear); the others keep their state. Fails on an unknown key or parameter,
    /// naming the nearest one, and on a value out of range.
    Status set_effects(EffectTarget target, const std::string& key, const std::vector<EffectValue>& parameters = {});
    /// Replaces all effects by a list, as "effects" of a scene; an empty one removes them.
    Status replace_effects(EffectTarget target, const std::vector<EffectDef>& definitions);
    /// Removes an effect. Without it the shell moves as one that never had it, from its present shape and velocity.
    Status remove_effect(EffectTarget target, const std::string& key);
    /// The effects of a shell with all their values, in the order in which they were given.
    [[nodiscard]] Result<std::vector<EffectDef>> effects(ShellHandle shell) const;

    // ---- Host bodies as shells see them. ----

    /// A conveyor: the surface of a body, or of one of its fixtures, moves along itself with a speed (m/s) that
    /// friction passes on to shells. The sign is that of b2Contact::SetTangentSpeed with the body as fixture A: a
    /// positive speed carries what lies on top to the right. 0 ends it. b2Contact::SetTangentSpeed itself acts on
    /// Box2D's contacts only. Fails if the host does not know the body.
    Status set_surface_speed(BodyId body, double speed, std::uint32_t fixture = all_fixtures);
    /// A veto on contacts of a shell with a host body, beside the collision filters; empty: none. At the start of each
    /// pre_step the filter is asked about each pair that may meet in the frame, any number of times and in any order.
    /// False keeps the two apart in that frame. post_step asks about bodies that the host carried past a shell. It may
    /// read the shells but not change them, and equal states must give equal answers. It is neither saved nor recorded.
    Status set_pair_filter(std::function<bool(const PairQuery&)> filter);
    /// Moves the origin of the coordinates to a point (m, in the old ones), of the shells and of the host world
    /// (b2World::ShiftOrigin) in one call. Motion goes on within rounding. Events and snapshots taken before keep the
    /// old coordinates. Fails inside the host's step, and with a host that cannot.
    Status shift_origin(Point new_origin);

    /// Moves the middle of the shell to a position (m) with its tangent at an angle (rad). Shape and velocity, in the
    /// shell's frame, stay. What it crosses there parts from it gently (OverlapEvent). Fails while the shell has holds
    /// or joints. A quarantined shell returns to the motion, at rest in its last accepted shape.
    Status teleport(ShellHandle shell, Point position, double angle);
    /// Gives the shell the velocity of a rigid body: of its middle (m/s), and spin (rad/s).
    Status set_velocity(ShellHandle shell, Point velocity, double spin = 0.0);
    Status set_material(ShellHandle shell, const MaterialDef& change);
    Status set_filter(ShellHandle shell, const FilterDef& filter);
    [[nodiscard]] Result<FilterDef> filter(ShellHandle shell) const;

    /// Friction coefficient between two materials (neither 0) of shells or bodies, in place of sqrt(mu_a mu_b).
    Status set_friction(FrictionMaterial a, FrictionMaterial b, double mu);
    /// Back to sqrt(mu_a mu_b).
    Status reset_friction(FrictionMaterial a, FrictionMaterial b);
    Status set_friction_material(ShellHandle shell, FrictionMaterial material);
    Status set_friction_material(BodyId body, FrictionMaterial material);
    /// The host's body of that name.
    [[nodiscard]] Result<BodyId> body(const std::string& name) const;

    /// Sleep. An island is a set of shells and dynamic bodies of the host that touch or are joined. It sleeps and wakes
    /// as a whole, does not move and costs no time. It wakes when an awake shell presses on it, when a body of the host
    /// moves near its shells or touches its bodies, when gravity changes, when the host or your program wakes, moves or
    /// changes one of its bodies, or when a call changes one of its shells. An island does not sleep while the host
    /// does not let one of its bodies sleep, or while it touches or is joined to a moving kinematic body.
    Status set_sleep(const SleepSettings& settings);
    [[nodiscard]] SleepSettings sleep_settings() const;
    /// At once, whatever the island's speed. Fails for islands with dynamic bodies, which fall asleep by themselves.
    Status sleep(ShellHandle shell);
    Status wake(ShellHandle shell);
    [[nodiscard]] Result<bool> asleep(ShellHandle shell) const;

    /// What becomes of quarantined shells, also of those that are. Fails unless `after` is finite and not negative.
    Status set_recovery(const RecoverySettings& settings);
    [[nodiscard]] RecoverySettings recovery() const;

    // ---- Testing machine: its crosshead carries bodies and holds (HoldBase::Moving). ----

    /// Attaches a kinematic host body to the crosshead; it follows the crosshead's velocity from now on.
    Status attach_to_crosshead(const std::string& body_name);
    /// Velocity of the crosshead, m/s.
    Status set_crosshead_velocity(Point velocity);
    /// Force of the shells on the crosshead in the last step, N.
    [[nodiscard]] Point crosshead_force() const;

    // ---- The step. ----

    /// Advances the shells by dt (s), in as many inner steps as they need, and passes impulses to the host. Call it
    /// before the host's own step. `observer` is called after each inner step; returning true ends the frame there.
    /// Then step the host by FrameReport::advanced. dt = 0 is a pause: nothing changes, and there are no events. Fails
    /// and changes nothing if dt is negative or thousands of steps long, and inside an observer.
    FrameReport pre_step(double dt, const std::function<bool()>& observer = {});
    /// Call it after the host's own step. Fails if the host does; the next pre_step then ignores that step.
    Status post_step();

    [[nodiscard]] Result<ShellPose> pose(ShellHandle shell) const;
    /// For games with fixed steps: the pose between the start (alpha = 0) and the end (1) of the last frame; alpha is
    /// clamped. A shell that was created, restored or teleported since is shown where it is. DrawOptions::alpha draws
    /// it.
    [[nodiscard]] Result<ShellPose> pose(ShellHandle shell, double alpha) const;
    [[nodiscard]] EnergyBalance energy_balance() const;
    [[nodiscard]] double time() const; ///< s

    // ---- Observing: events.hpp, queries.hpp, draw.hpp, snapshot.hpp; names. None of it changes how shells move. ----

    /// Events of the last pre_step; valid until the next one.
    [[nodiscard]] const FrameEvents& events() const;
    [[nodiscard]] const EventSettings& event_settings() const;
    /// Fails and changes nothing unless all are positive numbers.
    Status set_event_settings(const EventSettings& settings);

    /// All shells, in the order of creation.
    [[nodiscard]] std::vector<ShellHandle> shells() const;
    /// The first shell of that name in the order of creation; null if there is none.
    [[nodiscard]] ShellHandle find(const std::string& name) const;
    [[nodiscard]] Result<std::string> name(ShellHandle shell) const;
    [[nodiscard]] Result<std::uint64_t> user_data(ShellHandle shell) const;
    Status set_name(ShellHandle shell, const std::string& name);
    Status set_user_data(ShellHandle shell, std::uint64_t data);

    /// Where the ray from `from` to `to` first enters a shell. Fails if it hits none, or if its ends are equal or not
    /// finite.
    [[nodiscard]] Result<RayHit> ray_cast(Point from, Point to, QueryMask mask = 0xffff) const;
    /// Every point where the ray enters a shell (the same shell several times if it comes back), in the order along the
    /// ray; equal ones in the order of creation.
    [[nodiscard]] Result<std::vector<RayHit>> ray_cast_all(Point from, Point to, QueryMask mask = 0xffff) const;
    /// Shells that contain the point or overlap the (filled) box or the disc; in the order of creation.
    [[nodiscard]] Result<std::vector<ShellHandle>> overlap_point(Point point, QueryMask mask = 0xffff) const;
    [[nodiscard]] Result<std::vector<ShellHandle>> overlap_box(const Box& box, QueryMask mask = 0xffff) const;
    [[nodiscard]] Result<std::vector<ShellHandle>> overlap_circle(Point centre, double radius,
                                                                  QueryMask mask = 0xffff) const;
    /// The surface point closest to a point: of one shell, or of any shell within `max_distance` (m).
    [[nodiscard]] Result<ClosestPoint> closest_point(ShellHandle shell, Point point) const;
    [[nodiscard]] Result<ClosestPoint> closest_point(Point point,
                                                     double max_distance = std::numeric_limits<double>::infinity(),
                                                     QueryMask mask = 0xffff) const;
    [[nodiscard]] Result<ShellSection> section(ShellHandle shell, double arc_fraction) const;
    [[nodiscard]] Result<ShellState> state(ShellHandle shell) const;

    /// Draws everything; fails with the reason if `canvas` throws or the options are not usable.
    Status draw(DebugDraw& canvas, const DrawOptions& options = {}) const;

    /// The state that determines the shells' future, with names, user data and numerical settings. Not in it: the
    /// number of threads, and the state of observers and of the log.
    [[nodiscard]] Snapshot save() const;
    /// `world` of all handles these Shells give out.
    [[nodiscard]] std::uint32_t id() const;
    /// Restores a saved state. Handles of that time are valid again, those made since are stale for good. A snapshot
    /// from bytes or from other Shells makes all present handles stale and changes id(); its handles are valid here
    /// once their `world` is the new id(). Fails and changes nothing if the snapshot is empty or inconsistent, and
    /// inside an observer.
    Status restore(const Snapshot& snapshot);
    /// Hash of the state that determines the shells' future between frames; equal states have equal hashes on every
    /// machine. Not in it: counters of the numerics, handles, names and user data.
    [[nodiscard]] std::uint64_t hash() const;

    /// Clears the log and records every changing call from now on; `seed` is the user's own.
    Status start_log(std::uint64_t seed = 0);
    void stop_log();
    [[nodiscard]] CallLog log() const;
    /// Repeats the calls of a log here. `host_step(seconds)` is called where the host's own step is due, between
    /// pre_step and post_step; false ends the replay. Handles are translated.
    Status replay(const CallLog& log, const std::function<bool(double)>& host_step = {});

    // ---- End of observing. ----

    /// The core, for laboratories (include the core's headers to use it).
    [[nodiscard]] step::World& world();
    [[nodiscard]] const step::World& world() const;
    [[nodiscard]] step::Stepper& stepper();
    /// The host world of these shells; null if there is none.
    [[nodiscard]] std::shared_ptr<step::Port> host() const;

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; ///< never null and never shared, but by objects that were moved from
};

} // namespace supercircle
