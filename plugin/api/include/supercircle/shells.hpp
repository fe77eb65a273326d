#pragma once
// Flexible shells in somebody's rigid world:
//
//     auto shells = supercircle::Shells(bridge::attach(world, {.units_per_metre = 52.1}));
//     auto shell  = shells.create(ShellDef{});
//     shells.pre_step(dt);  world.Step(dt, 8, 3);  shells.post_step();      // you keep calling world.Step
//
// Definitions in, handles out; SI units. Bad input is answered by a Result and changes nothing; no call lets an
// exception out (std::bad_alloc excepted). Any number of Shells may live side by side, each to be used by one thread at
// a time.
//
// During pre_step (from its observer, or from a host that is asked) the shells may be read but not changed: every
// changing call is refused with kStepping, and is to be made after pre_step. Between pre_step and post_step - also from
// the callbacks of the host's own step - everything is allowed.

#include "definitions.hpp"
#include "draw.hpp"
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

/// How much work the numbers are worth. Both obey the same law: inextensible shells, exact Coulomb friction, no
/// crossing.
enum class Quality : std::uint8_t {
    Laboratory, ///< steps as short as the accuracy of forces and energies asks for, however many: the default
    Game        ///< steps up to a frame of 1/60 s and a budget of work per frame (docs/guide.md has the errors)
};

/// What one frame did.
struct FrameReport {
    double advanced = 0.0; ///< s; less than asked for only when stopped, late or failed
    bool late = false;     ///< Quality::Game: the frame's budget was used up; the rest of dt was not simulated
    bool stopped = false;  ///< the observer asked to stop, or threw (then failure says what)
    std::string failure;   ///< empty unless the shells could not go on
    std::uint64_t steps = 0;
    std::uint64_t unconverged = 0; ///< steps whose contact residual stayed above tolerance
};

/// The energy books since creation, J (see docs/architecture.md). stored - added = work - losses.
struct EnergyBooks {
    double kinetic = 0.0, bending = 0.0, gravity = 0.0;
    double added = 0.0, work = 0.0, friction = 0.0, impact = 0.0, numerical = 0.0, push_out = 0.0, effects = 0.0,
           to_bodies = 0.0, residual = 0.0;
};

/// Where a shell is.
struct ShellPose {
    Point start{};                 ///< first end, m
    double angle = 0.0;            ///< tangent angle there, rad
    std::vector<double> curvature; ///< per element, 1/m
    double bending_energy = 0.0;   ///< J
};

/// Why changing calls are refused during pre_step.
inline const char* const kStepping = "the shells are being stepped: change them after pre_step, not from its observer";

class Shells {
public:
    /// `port` is the host world (bridge::attach); null: shells alone, without gravity and walls.
    explicit Shells(std::shared_ptr<step::Port> port);
    ~Shells();
    Shells(Shells&&) noexcept;
    Shells& operator=(Shells&&) noexcept;

    /// Selects the resolution of the numerics; at any time. Settings made through stepper() are replaced.
    Outcome set_quality(Quality quality);
    [[nodiscard]] Quality quality() const;
    /// Quality::Game: work a frame may take, in contacts solved (about 3 us each, a shell counts four); 0: no limit. At
    /// a quarter of it steps get coarser, at all of it the frame ends early (FrameReport::late). set_quality resets it.
    /// Refused in Quality::Laboratory.
    Outcome set_frame_budget(std::uint64_t work);
    /// Threads that pre_step may use, 1 to 256; the results do not depend on it.
    Outcome set_threads(int threads);

    /// Puts a shell into the world. Fails with a reason on bad numbers.
    Result<ShellHandle> create(const ShellDef& definition);
    /// Takes it out, with all that holds, joins and pulls it. Fails if the handle is stale.
    Outcome destroy(ShellHandle shell);
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] bool valid(ShellHandle shell) const;

    // ---- Mechanics: mechanics.hpp. Places on a shell are arc fractions, 0 = first end, 1 = last end. ----

    /// Holds the point at `arc_fraction` where it is now, on the ground or on the machine.
    Result<HoldHandle> hold(ShellHandle shell, double arc_fraction, HoldKind kind, bool on_machine = false);
    Result<HoldHandle> clamp(ShellHandle shell, double arc_fraction) {
        return hold(shell, arc_fraction, HoldKind::Clamp);
    }
    Result<HoldHandle> pin(ShellHandle shell, double arc_fraction) { return hold(shell, arc_fraction, HoldKind::Pin); }
    /// Where the held point shall be at the end of the coming frame. Not for holds on the machine.
    Outcome drive(HoldHandle hold, const DriveDef& to);
    /// Where it is asked to be now, and its velocity: what to start a DriveDef from.
    [[nodiscard]] Result<DriveDef> target(HoldHandle hold) const;
    [[nodiscard]] Result<Reaction> reaction(HoldHandle hold) const;
    Outcome release(HoldHandle hold);

    Result<JointHandle> join(const JointDef& definition);
    /// Moves the place a tether is tied to (tethers to the world only; angle and spin do not count).
    Outcome drive(JointHandle joint, const DriveDef& to);
    [[nodiscard]] Result<DriveDef> target(JointHandle joint) const;
    /// Makes a tether longer or shorter at `rate` (m/s, positive) until it has `length` (m, positive).
    Outcome reel(JointHandle joint, double length, double rate);
    [[nodiscard]] Result<double> length(JointHandle joint) const; ///< of a tether now, m
    [[nodiscard]] Result<Reaction> reaction(JointHandle joint) const;
    Outcome release(JointHandle joint);

    Result<GrabHandle> grab(ShellHandle shell, const GrabDef& definition);
    Outcome move(GrabHandle grab, Point target);
    [[nodiscard]] Result<Reaction> reaction(GrabHandle grab) const;
    Outcome release(GrabHandle grab);

    /// Force (N) and torque (N m) during the coming pre_step; several add up.
    Outcome apply_force(ShellHandle shell, double arc_fraction, Point force, double torque = 0.0);
    Outcome apply_torque(ShellHandle shell, double arc_fraction, double torque);
    /// Changes the motion at once by an impulse (N s) and an angular impulse (N m s).
    Outcome apply_impulse(ShellHandle shell, double arc_fraction, Point impulse, double angular_impulse = 0.0);
    /// A force that lasts until it is changed or released.
    Result<ForceHandle> add_force(ShellHandle shell, double arc_fraction, Point force, double torque = 0.0);
    Outcome set_force(ForceHandle handle, Point force, double torque = 0.0);
    Outcome release(ForceHandle handle);

    [[nodiscard]] bool valid(HoldHandle handle) const;
    [[nodiscard]] bool valid(JointHandle handle) const;
    [[nodiscard]] bool valid(GrabHandle handle) const;
    [[nodiscard]] bool valid(ForceHandle handle) const;

    /// Puts the middle of the shell at a place (m) with its tangent at an angle (rad), its shape and its velocity in
    /// its own frame kept; whether it is free of others there is not checked. Refused while it is held or joined. A
    /// shell that was taken out of the motion (FrameEvents::quarantined) comes back with it, at rest in its last good
    /// shape.
    Outcome teleport(ShellHandle shell, Point position, double angle);
    /// Gives it the velocity of a rigid body: of its middle (m/s), and spin (rad/s).
    Outcome set_velocity(ShellHandle shell, Point velocity, double spin = 0.0);
    Outcome set_material(ShellHandle shell, const MaterialDef& change);
    Outcome set_filter(ShellHandle shell, const FilterDef& filter);
    [[nodiscard]] Result<FilterDef> filter(ShellHandle shell) const;

    /// Friction coefficient between two materials (neither 0), of shells or bodies, in place of sqrt(mu_a mu_b).
    Outcome set_friction(MaterialId a, MaterialId b, double mu);
    /// Back to sqrt(mu_a mu_b).
    Outcome reset_friction(MaterialId a, MaterialId b);
    Outcome set_surface(ShellHandle shell, MaterialId material);
    Outcome set_surface(BodyId body, MaterialId material);
    /// The host's body of that name.
    [[nodiscard]] Result<BodyId> body(const std::string& name) const;

    /// Sleep. An island is what touches and is joined; it sleeps and wakes as a whole, does not move and costs nothing.
    /// It wakes when an awake shell presses on it, a body of the host moves near it, gravity changes, or a call changes
    /// one of its shells. Islands that touch or are joined to dynamic or moving bodies do not sleep.
    Outcome set_sleep(const SleepSettings& settings);
    [[nodiscard]] SleepSettings sleep_settings() const;
    Outcome sleep(ShellHandle shell);
    Outcome wake(ShellHandle shell);
    [[nodiscard]] Result<bool> asleep(ShellHandle shell) const;

    // ---- End of mechanics. ----

    /// Names the kinematic host bodies that the machine carries; they follow the machine velocity from now on.
    Outcome carry(const std::string& body_name);
    /// Velocity of the machine: of the bodies it carries and of the holds on it, m/s.
    Outcome set_machine_velocity(Point velocity);
    /// Force of the shells on the machine in the last step, N.
    [[nodiscard]] Point machine_force() const;

    /// Advances the shells by dt (s), in as many inner steps as they need, and hands impulses to the host. Call before
    /// the host's own step. `observer` sees each inner step; returning true ends the frame there (then step the host by
    /// FrameReport::advanced). Refused, with a reason and nothing changed: dt that is not a positive number or
    /// thousands of steps long, and a pre_step from within an observer.
    FrameReport pre_step(double dt, const std::function<bool()>& observer = {});
    /// Call after the host's own step. Fails if the host does; the next pre_step then learns nothing from that step.
    Outcome post_step();

    [[nodiscard]] Result<ShellPose> pose(ShellHandle shell) const;
    [[nodiscard]] EnergyBooks books() const;
    [[nodiscard]] double time() const; ///< s

    // ---- Observing: events.hpp, queries.hpp, draw.hpp, snapshot.hpp; names. None of it changes how shells move. ----

    /// What happened in the last pre_step; good until the next one.
    [[nodiscard]] const FrameEvents& events() const;
    [[nodiscard]] const EventSettings& event_settings() const;
    /// Refused, and nothing changed, unless all are positive numbers.
    Outcome set_event_settings(const EventSettings& settings);

    /// All shells, in the order of creation.
    [[nodiscard]] std::vector<ShellHandle> list() const;
    /// The first shell of that name in the order of creation; null if there is none.
    [[nodiscard]] ShellHandle find(const std::string& name) const;
    [[nodiscard]] Result<std::string> name(ShellHandle shell) const;
    [[nodiscard]] Result<std::uint64_t> user_data(ShellHandle shell) const;
    Outcome set_name(ShellHandle shell, const std::string& name);
    Outcome set_user_data(ShellHandle shell, std::uint64_t data);

    /// Where the way from `from` to `to` first enters a shell. Fails when it meets none, or its ends are not finite or
    /// the same.
    [[nodiscard]] Result<RayHit> ray_cast(Point from, Point to, QueryMask mask = 0xffff) const;
    /// Every place where it enters a shell (the same one more than once if it comes back), nearest first; of equal ones
    /// the shell made first.
    [[nodiscard]] Result<std::vector<RayHit>> ray_cast_all(Point from, Point to, QueryMask mask = 0xffff) const;
    /// Shells that contain the point, meet the (filled) box or the disc; in the order of creation.
    [[nodiscard]] Result<std::vector<ShellHandle>> overlap_point(Point point, QueryMask mask = 0xffff) const;
    [[nodiscard]] Result<std::vector<ShellHandle>> overlap_box(const Box& box, QueryMask mask = 0xffff) const;
    [[nodiscard]] Result<std::vector<ShellHandle>> overlap_circle(Point centre, double radius,
                                                                  QueryMask mask = 0xffff) const;
    /// The surface point of a shell, or of any shell no farther than `farthest` (m), nearest to a point.
    [[nodiscard]] Result<NearestPoint> nearest(ShellHandle shell, Point point) const;
    [[nodiscard]] Result<NearestPoint> nearest(Point point, double farthest = std::numeric_limits<double>::infinity(),
                                               QueryMask mask = 0xffff) const;
    [[nodiscard]] Result<ShellSection> section(ShellHandle shell, double arc_fraction) const;
    [[nodiscard]] Result<ShellMeasures> measure(ShellHandle shell) const;

    /// Draws everything; fails with the reason if `canvas` throws or the options are not usable.
    Outcome draw(DebugDraw& canvas, const DrawOptions& options = {}) const;

    /// All that the shells' future depends on, with names, user data and numerical settings (but not the number of
    /// threads, nor what an observer or the log remembers).
    [[nodiscard]] Snapshot save() const;
    /// `world` of all handles these Shells give out.
    [[nodiscard]] std::uint32_t id() const;
    /// Puts everything back; handles of then are valid again, those of shells and parts made since are stale for good.
    /// A snapshot read from bytes or saved by other Shells makes all handles of these stale and changes id(); handles
    /// of then are good here once their `world` is set to the new id(). Fails, and changes nothing, on a snapshot that
    /// is empty or does not fit together, and from within an observer.
    Outcome restore(const Snapshot& snapshot);
    /// Of all that decides the future of the shells, on every machine the same: equal states, equal hashes. Not in it:
    /// counters of the numerics, handles, names and user data. Of states between frames: what is left of a frame under
    /// way is neither in it nor in a Snapshot.
    [[nodiscard]] std::uint64_t hash() const;

    /// Forgets what was logged and logs every changing call from now on; `seed` is the user's own.
    Outcome start_log(std::uint64_t seed = 0);
    void stop_log();
    [[nodiscard]] CallLog log() const;
    /// Makes the calls of a log again, here. `host_step(seconds)` is called where the host's own step is due, between
    /// pre_step and post_step; false ends the replay. Handles are translated.
    Outcome replay(const CallLog& log, const std::function<bool(double)>& host_step = {});

    // ---- End of observing. ----

    /// The core behind the facade, for laboratories (include the core's headers to use it).
    [[nodiscard]] step::World& world();
    [[nodiscard]] const step::World& world() const;
    [[nodiscard]] step::Stepper& stepper();
    /// The host world these shells live in; null if they live alone.
    [[nodiscard]] std::shared_ptr<step::Port> host() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle
