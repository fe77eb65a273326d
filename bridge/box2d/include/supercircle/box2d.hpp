#pragma once
// Shells in a Box2D 2.4.1 world of yours: the one header of the bridge a program needs (no Eigen, no core headers).
//
//     b2World world({0.0f, -9.81f});
//     supercircle::Shells shells(supercircle::bridge::attach(world));       // once
//     shells.pre_step(dt);  world.Step(dt, 8, 3);  shells.post_step();      // every frame

#include <cstdint>
#include <memory>
#include <string>

class b2Body;
class b2World;

namespace supercircle::step {
class Port;
}

namespace supercircle::bridge {

class Box2dPort;

struct Options {
    double units_per_metre = 1.0; ///< Box2D length units per metre, 1/m; finite and positive
};

/// What attach() returns: hand it to Shells, or keep a copy to name bodies. It points to the world, which must outlive
/// it and every Shells made of it. Copies are the same attachment.
class Attachment {
public:
    Attachment(std::shared_ptr<step::Port> owner, Box2dPort* port) : owner_(std::move(owner)), port_(port) {}

    /// Names a body of this world, so that Shells::carry() finds it; a later body of the same name replaces it.
    void set_name(const b2Body& body, const std::string& name) const;
    /// What Shells::join and Shells::set_surface call this body; 0 if it is not of this world.
    [[nodiscard]] std::uint64_t body_id(const b2Body& body) const;
    /// Tells that this body is about to be destroyed. Only needed when another one, equal in type, user data, mass and
    /// fixtures, may come to its address before the next frame.
    void forget(const b2Body& body) const;
    /// Calls that carried bad numbers or named no body of this world; they changed nothing.
    [[nodiscard]] std::uint64_t refused() const;
    [[nodiscard]] std::string last_refusal() const;

    /// The port itself; its class is in the core's header bridge/box2d_port.h.
    Box2dPort* operator->() const { return port_; }
    Box2dPort& operator*() const { return *port_; }
    [[nodiscard]] Box2dPort* get() const { return port_; }
    operator std::shared_ptr<step::Port>() const { return owner_; } // NOLINT: Shells(attach(world)) is the point

private:
    std::shared_ptr<step::Port> owner_;
    Box2dPort* port_;
};

/// Couples shells to the user's world, which stays the user's: bodies may come and go, and the user goes on stepping
/// it. Throws std::invalid_argument when units_per_metre is not finite and positive.
Attachment attach(b2World& world, const Options& options = {});

} // namespace supercircle::bridge
