#pragma once
// The core's port on a Box2D 3.1 world that belongs to the user.

#include "bridge/box2d3/include/supercircle/box2d3.hpp"
#include "supercircle/step/port.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::box2d3 {

/// A step::Port on the world of a b2WorldId. Scales as in bridge/box2d/box2d_port.h: lengths, velocities, gravity and
/// impulses times L = units_per_metre; inertia and angular impulse times L^2; mass, time and angles as they are.
///
/// Body ids are Box2D's own, index and generation, without the world's number: equal histories have equal ids in
/// whichever world they run. The id of a destroyed body stays invalid (until its slot was used 65536 times).
///
/// The host's own contacts and joints are not passed to the core (constraints() lists none). They act, but only once
/// per frame.
///
/// Do not call it from within the world's own step, whose callbacks run on several threads. Invalid calls do not reach
/// Box2D and change nothing; errorCount() counts them and lastError() gives the reason.
class Box2d3Port : public step::Port {
public:
    Box2d3Port(b2WorldId world, const Options& options);
    ~Box2d3Port() override;
    Box2d3Port(const Box2d3Port&) = delete;
    Box2d3Port& operator=(const Box2d3Port&) = delete;

    [[nodiscard]] step::Vec2 gravity() const override;
    [[nodiscard]] double unitsPerMetre() const override;
    /// Leaves out sensors, disabled bodies and shapes whose mask is 0. Boxes of moving bodies carry Box2D's margin.
    void query(const step::Box& box, std::vector<step::BodyOutline>& out) const override;
    void queryAhead(std::span<const step::Box> boxes, double ahead, std::vector<step::BodyOutline>& out) const override;
    [[nodiscard]] bool state(step::BodyId body, step::BodyState& out) const override;
    /// Lists nothing, but starts a frame of `dt` s (see applyImpulse).
    void constraints(const std::vector<step::BodyId>& seeds, double dt, step::HostConstraints& out) const override;
    void impulses(double dt, step::HostConstraints& io) const override;
    void applyImpulse(step::BodyId body, const step::Vec2& impulse, double angularImpulse) override;
    void setVelocity(step::BodyId body, const step::Vec2& velocity, double spin) override;
    /// state() lets a body sleep only while no other dynamic body touches it or is joined to it: constraints() lists
    /// none, so that the core cannot tell what must sleep together.
    void setAwake(step::BodyId body, bool awake) override;
    void place(step::BodyId body, const step::Vec2& centre, double angle) override;
    void drive(step::BodyId body, const step::Vec2& centre, double angle, const step::Vec2& velocity,
               double spin) override;
    [[nodiscard]] step::BodyId find(const std::string& name) const override;

    /// All outlines of all enabled bodies, sorted by (body, key).
    void everything(std::vector<step::BodyOutline>& out) const;
    /// The id of a living body of this world; 0 if it is not one.
    [[nodiscard]] step::BodyId idOf(b2BodyId body) const;
    void setName(b2BodyId body, const std::string& name);

    [[nodiscard]] std::uint64_t errorCount() const;
    [[nodiscard]] const std::string& lastError() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::box2d3
