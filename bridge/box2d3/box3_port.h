#pragma once
// The core's port on a Box2D 3.1 world that belongs to the user.

#include "bridge/box2d3/include/supercircle/box2d3.hpp"
#include "supercircle/step/port.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::box3 {

/// A step::Port on the world of a b2WorldId. Scales as in bridge/box2d/box2d_port.h: lengths, velocities, gravity and
/// impulses times L = units_per_metre; inertia and angular impulse times L^2; mass, time and angles as they are.
///
/// Body ids are Box2D's own, index and generation, without the world's number: equal histories have equal ids in
/// whichever world they run. A destroyed body's id stays dead (until its slot was used 65536 times).
///
/// Not told to the core in this version: the host's own contacts and joints (constraints() lists none). They act, but
/// only once a frame, see docs/guide.md.
///
/// No call may come from within the world's own step (its callbacks run on several threads). Bad numbers and misuse
/// never reach Box2D: the call changes nothing, refused() counts it and lastRefusal() says why.
class Box3Port : public step::Port {
public:
    Box3Port(b2WorldId world, const Options& options);
    ~Box3Port() override;
    Box3Port(const Box3Port&) = delete;
    Box3Port& operator=(const Box3Port&) = delete;

    [[nodiscard]] step::Vec2 gravity() const override;
    [[nodiscard]] double unitsPerMetre() const override;
    /// Leaves out sensors, disabled bodies and shapes whose mask is 0. Boxes of moving bodies carry Box2D's margin.
    void query(const step::Box& box, std::vector<step::BodyOutline>& out) const override;
    [[nodiscard]] bool state(step::BodyId body, step::BodyState& out) const override;
    /// Lists nothing, but starts a frame of `dt` s (see applyImpulse).
    void constraints(const std::vector<step::BodyId>& seeds, double dt, step::HostConstraints& out) const override;
    void impulses(double dt, step::HostConstraints& io) const override;
    void applyImpulse(step::BodyId body, const step::Vec2& impulse, double angularImpulse) override;
    void setVelocity(step::BodyId body, const step::Vec2& velocity, double spin) override;
    void place(step::BodyId body, const step::Vec2& centre, double angle) override;
    void drive(step::BodyId body, const step::Vec2& centre, double angle, const step::Vec2& velocity,
               double spin) override;
    [[nodiscard]] step::BodyId find(const std::string& name) const override;

    /// All outlines of all enabled bodies, sorted by (body, key).
    void everything(std::vector<step::BodyOutline>& out) const;
    /// The id of a living body of this world; 0 if it is not one.
    [[nodiscard]] step::BodyId idOf(b2BodyId body) const;
    void setName(b2BodyId body, const std::string& name);

    [[nodiscard]] std::uint64_t refused() const;
    [[nodiscard]] const std::string& lastRefusal() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::box3
