#pragma once
// Flexible shells in somebody's rigid world:
//
//     auto shells = supercircle::Shells(bridge::attach(world, {.units_per_metre = 52.1}));
//     auto shell  = shells.create(ShellDef{});
//     shells.pre_step(dt);  world.Step(dt, 8, 3);  shells.post_step();      // you keep calling world.Step
//
// Definitions in, handles out; SI units; no exceptions leave pre_step and post_step; bad input is answered by a Result.

#include "definitions.hpp"
#include "draw.hpp"
#include "events.hpp"
#include "handle.hpp"
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

/// What one frame did.
struct FrameReport {
    double advanced = 0.0; ///< s; less than asked for only when stopped or failed
    bool stopped = false;  ///< the observer asked to stop
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

class Shells {
public:
    /// `port` is the host world (bridge::attach); null: shells alone, without gravity and walls.
    explicit Shells(std::shared_ptr<step::Port> port);
    ~Shells();
    Shells(Shells&&) noexcept;
    Shells& operator=(Shells&&) noexcept;

    /// Puts a shell into the world. Fails with a reason on bad numbers.
    Result<ShellHandle> create(const ShellDef& definition);
    /// False if the handle is stale.
    bool destroy(ShellHandle shell);
    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] bool valid(ShellHandle shell) const;

    /// Holds the point at `arc_fraction` where it is now. Returns the hold's number on that shell.
    Result<int> hold(ShellHandle shell, double arc_fraction, HoldKind kind, bool on_machine = false);

    /// Names the kinematic host bodies that the machine carries; they follow the machine velocity from now on.
    bool carry(const std::string& body_name);
    /// Velocity of the machine: of the bodies it carries and of the holds on it, m/s. Not finite: ignored.
    void set_machine_velocity(Point velocity);
    /// Force of the shells on the machine in the last step, N.
    [[nodiscard]] Point machine_force() const;

    /// Advances the shells by dt (s), in as many inner steps as they need, and hands impulses to the host. Call before
    /// the host's own step. `observer` sees each inner step; returning true ends the frame there (then step the host by
    /// FrameReport::advanced). Refused, with a reason and nothing changed: dt that is not a positive number or
    /// thousands of steps long, and a pre_step from within an observer.
    FrameReport pre_step(double dt, const std::function<bool()>& observer = {});
    /// Call after the host's own step.
    void post_step();

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
    /// False if the handle is stale.
    bool set_name(ShellHandle shell, const std::string& name);
    bool set_user_data(ShellHandle shell, std::uint64_t data);

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
    /// Puts everything back; handles of then are valid again, those of shells made since are stale for good. In other
    /// Shells than it came from, find the shells by name or list(). Fails, and changes nothing, on a snapshot that is
    /// empty or does not fit together, and from within an observer.
    Outcome restore(const Snapshot& snapshot);
    /// Of all that decides the future of the shells, on every machine the same: equal states, equal hashes. Not in it:
    /// counters of the numerics, handles, names and user data.
    [[nodiscard]] std::uint64_t hash() const;

    /// Forgets what was logged and logs every changing call from now on; `seed` is the user's own.
    void start_log(std::uint64_t seed = 0);
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
