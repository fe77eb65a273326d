#pragma once
// Shells in a Box2D 3.1 world of yours: what box2d.hpp is for Box2D 2.4.1. One program uses one of the two Box2Ds.
//
//     supercircle::Shells shells(supercircle::box3::attach(world));               // once
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

namespace supercircle::box3 {

class Box3Port;

struct Options {
    double units_per_metre = 1.0; ///< Box2D length units per metre, 1/m; finite and positive
    int substeps = 4;             ///< as given to b2World_Step, at least 1
};

/// What attach() returns: hand it to Shells, or keep a copy to name bodies. Copies are the same attachment. When the
/// world is destroyed first, the shells go on without bodies.
class Attachment {
public:
    Attachment(std::shared_ptr<step::Port> owner, Box3Port* port) : owner_(std::move(owner)), port_(port) {}

    /// Names a body of this world, so that Shells::carry() finds it; a later body of the same name replaces it.
    void set_name(b2BodyId body, const std::string& name) const;
    /// What Shells::join and Shells::set_surface call this body; 0 if it is not of this world.
    [[nodiscard]] std::uint64_t body_id(b2BodyId body) const;
    /// Calls that carried bad numbers or named no body of this world; they changed nothing.
    [[nodiscard]] std::uint64_t refused() const;
    [[nodiscard]] std::string last_refusal() const;

    /// The port itself; its class is in the core's header bridge/box2d3/box3_port.h.
    Box3Port* operator->() const { return port_; }
    Box3Port& operator*() const { return *port_; }
    [[nodiscard]] Box3Port* get() const { return port_; }
    operator std::shared_ptr<step::Port>() const { return owner_; } // NOLINT: Shells(attach(world)) is the point

private:
    std::shared_ptr<step::Port> owner_;
    Box3Port* port_;
};

/// Couples shells to the user's world, which stays the user's. Throws std::invalid_argument when the world does not
/// exist, units_per_metre is not finite and positive or substeps is below 1.
Attachment attach(b2WorldId world, const Options& options = {});

} // namespace supercircle::box3
