#pragma once
// Shells in your Box2D 3.1 world, as box2d.hpp for Box2D 2.4.1. A program uses one of the two Box2D versions.
//
//     supercircle::Shells shells(supercircle::box2d3::attach(world));             // once
//     const auto report = shells.pre_step(dt);                                    // every frame
//     b2World_Step(world, static_cast<float>(report.advanced), 4);
//     shells.post_step();

#include <cstdint>
#include <memory>
#include <string>

struct b2BodyId;
struct b2WorldId;

namespace supercircle::step {
class Port;
}

namespace supercircle::box2d3 {

class Box2d3Port;

struct Options {
    double units_per_metre = 1.0; ///< Box2D length units per metre, 1/m; finite and positive
    int substeps = 4;             ///< as passed to b2World_Step, 1, at least 1
};

/// The result of attach(): pass it to Shells, or keep a copy to name bodies. Copies refer to the same attachment. If
/// the world is destroyed first, the shells continue without bodies.
class Attachment {
public:
    Attachment(std::shared_ptr<step::Port> owner, Box2d3Port* port) : owner_(std::move(owner)), port_(port) {}

    /// Names a body of this world, so that Shells::attach_to_crosshead() finds it. A later body of that name replaces
    /// it.
    void set_name(b2BodyId body, const std::string& name) const;
    /// The id of this body for Shells::create_joint and Shells::set_friction_material; 0 if it is not of this world.
    [[nodiscard]] std::uint64_t body_id(b2BodyId body) const;
    /// Number of calls with invalid numbers or an unknown body. Such calls change nothing.
    [[nodiscard]] std::uint64_t error_count() const;
    /// Message of the last such call; empty if there was none.
    [[nodiscard]] std::string last_error() const;

    [[deprecated("use error_count")]] [[nodiscard]] std::uint64_t refused() const { return error_count(); }
    [[deprecated("use last_error")]] [[nodiscard]] std::string last_refusal() const { return last_error(); }

    /// The port itself; its class is in the core's header bridge/box2d3/box2d3_port.h.
    Box2d3Port* operator->() const { return port_; }
    Box2d3Port& operator*() const { return *port_; }
    [[nodiscard]] Box2d3Port* get() const { return port_; }
    operator std::shared_ptr<step::Port>() const { return owner_; } // NOLINT: implicit, for Shells(attach(world))

private:
    std::shared_ptr<step::Port> owner_;
    Box2d3Port* port_;
};

/// Couples shells to the user's world, which the user keeps stepping. Throws std::invalid_argument when the world does
/// not exist, units_per_metre is not finite and positive or substeps is below 1.
Attachment attach(b2WorldId world, const Options& options = {});

using Box3Port [[deprecated("use Box2d3Port")]] = Box2d3Port;

} // namespace supercircle::box2d3

namespace supercircle {
namespace box3 = box2d3; // deprecated name of version 0.1
}
