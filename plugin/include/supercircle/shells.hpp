#pragma once
// Flexible shells in somebody's rigid world:
//
//     auto shells = supercircle::Shells(bridge::attach(world, {.units_per_metre = 52.1}));
//     auto shell  = shells.create(ShellDef{});
//     shells.pre_step(dt);  world.Step(dt, 8, 3);  shells.post_step();      // you keep calling world.Step
//
// Definitions in, handles out; SI units; no exceptions leave pre_step and post_step; bad input is answered by a Result.

#include "definitions.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace supercircle {

namespace step {
class Port;
struct World;
struct Settings;
class Stepper;
} // namespace step

/// Names a shell; survives misuse: a stale or foreign handle gives an error, never a crash. Zero is nobody.
struct ShellHandle {
    std::uint32_t index = 0;
    std::uint32_t generation = 0;
    std::uint32_t world = 0; ///< which Shells it belongs to
    [[nodiscard]] bool null() const { return generation == 0; }
    friend bool operator==(const ShellHandle&, const ShellHandle&) = default;
};

/// A value or the reason why there is none.
template <class T>
class Result {
public:
    Result(T value) : value_(std::move(value)) {}
    static Result failure(std::string why) {
        Result r;
        r.error_ = std::move(why);
        return r;
    }
    explicit operator bool() const { return value_.has_value(); }
    [[nodiscard]] const T& value() const { return *value_; }
    [[nodiscard]] const T& operator*() const { return *value_; }
    [[nodiscard]] const T* operator->() const { return &*value_; }
    [[nodiscard]] const std::string& error() const { return error_; }

private:
    Result() = default;
    std::optional<T> value_;
    std::string error_;
};

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
    /// Velocity of the machine: of the bodies it carries and of the holds on it, m/s.
    void set_machine_velocity(Point velocity);
    /// Force of the shells on the machine in the last step, N.
    [[nodiscard]] Point machine_force() const;

    /// Advances the shells by dt (s), in as many inner steps as they need, and hands impulses to the host. Call before
    /// the host's own step. `observer` sees each inner step; returning true ends the frame there (then step the host by
    /// FrameReport::advanced).
    FrameReport pre_step(double dt, const std::function<bool()>& observer = {});
    /// Call after the host's own step.
    void post_step();

    [[nodiscard]] Result<ShellPose> pose(ShellHandle shell) const;
    [[nodiscard]] EnergyBooks books() const;
    [[nodiscard]] double time() const; ///< s

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
