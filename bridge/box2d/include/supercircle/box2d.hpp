#pragma once
// Shells in your Box2D 2.4.1 world: the one header of the bridge that a program needs (no Eigen, no core headers).
//
//     b2World world({0.0f, -9.81f});
//     supercircle::Shells shells(supercircle::bridge::attach(world));       // once
//     shells.pre_step(dt);  world.Step(dt, 8, 3);  shells.post_step();      // every frame

#include <cstdint>
#include <memory>
#include <string>

class b2Body;
class b2Fixture;
class b2World;

namespace supercircle::step {
class Port;
}

namespace supercircle::bridge {

class Box2dPort;

struct Options {
    double units_per_metre = 1.0; ///< Box2D length units per metre, 1/m; finite and positive
};

/// The result of attach(): pass it to Shells, or keep a copy to name bodies. It points to the world, which must outlive
/// it and every Shells created from it. Copies refer to the same attachment.
class Attachment {
public:
    Attachment(std::shared_ptr<step::Port> owner, Box2dPort* port) : owner_(std::move(owner)), port_(port) {}

    /// Names a body of this world, so that Shells::attach_to_crosshead() finds it. A later body of that name replaces
    /// it.
    void set_name(const b2Body& body, const std::string& name) const;
    /// The id of this body for Shells::create_joint and Shells::set_friction_material; 0 if it is not of this world.
    [[nodiscard]] std::uint64_t body_id(const b2Body& body) const;
    /// The body with this id, as events and queries name it; null if it does not exist any more. Valid until the user
    /// destroys the body.
    [[nodiscard]] b2Body* body(std::uint64_t id) const;
    /// The fixture of a body by its number, 0 for the oldest; null if there is none.
    [[nodiscard]] b2Fixture* fixture(std::uint64_t body, std::uint32_t number) const;
    /// The number of a fixture on its body, for Shells::set_surface_speed and in PairQuery. Destroying an older fixture
    /// changes it.
    [[nodiscard]] std::uint32_t fixture_number(const b2Fixture& fixture) const;
    /// Call this before destroying a body. Only needed if another body, equal in type, user data, mass and fixtures,
    /// may be created at its address before the next frame.
    void notify_destroyed(const b2Body& body) const;
    /// Number of calls with invalid numbers or an unknown body. Such calls change nothing.
    [[nodiscard]] std::uint64_t error_count() const;
    /// Message of the last such call; empty if there was none.
    [[nodiscard]] std::string last_error() const;

    [[deprecated("use notify_destroyed")]] void forget(const b2Body& body) const { notify_destroyed(body); }
    [[deprecated("use error_count")]] [[nodiscard]] std::uint64_t refused() const { return error_count(); }
    [[deprecated("use last_error")]] [[nodiscard]] std::string last_refusal() const { return last_error(); }

    /// The port itself; its class is in the core's header bridge/box2d/box2d_port.h.
    Box2dPort* operator->() const { return port_; }
    Box2dPort& operator*() const { return *port_; }
    [[nodiscard]] Box2dPort* get() const { return port_; }
    operator std::shared_ptr<step::Port>() const { return owner_; } // NOLINT: implicit, for Shells(attach(world))

private:
    std::shared_ptr<step::Port> owner_;
    Box2dPort* port_;
};

/// Couples shells to the user's world. The user keeps stepping the world and may add and remove bodies. Throws
/// std::invalid_argument when units_per_metre is not finite and positive.
Attachment attach(b2World& world, const Options& options = {});

} // namespace supercircle::bridge
