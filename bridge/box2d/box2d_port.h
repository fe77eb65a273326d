#pragma once
// The core's port on a Box2D 2.4.1 world that belongs to the user. The only float <-> double border of the project.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::bridge {

/// A step::Port on a b2World. It keeps a pointer to the world, which must outlive it, and no other pointer is followed
/// before the world's own body list has confirmed it.
///
/// Scales, with L = units_per_metre: lengths, velocities, gravity, forces and impulses times L; inertia, torque and
/// angular impulse times L^2; mass, time and angles as they are.
///
/// Body ids. Box2D tells nobody when a body is destroyed, and hands its address to the next one. Ids rely on the world
/// keeping its bodies in order of creation: a body whose place in that order changed is a new one. One case cannot be
/// seen that way: the youngest body is destroyed and one is made at its address before the port looks again. It is told
/// apart by type, user data, mass, inertia and fixtures; when all of these agree too, the successor inherits the id
/// (its pose and velocity are read afresh, so nothing physical is stale). Call forget() where that matters. Bodies
/// destroyed between two calls of query() are noticed by query(), and by the others as soon as the world's body count
/// or youngest body differ.
///
/// Locked world (inside its callbacks): reading works; applyImpulse and drive wait, in order, for the first call on the
/// port after the world is unlocked.
///
/// Bad numbers and misuse (non-finite values, drive on a body that is not kinematic) never reach Box2D, which would
/// abort: the call changes nothing, refused() counts it and lastRefusal() says why.
class Box2dPort : public step::Port {
public:
    Box2dPort(b2World& world, const Options& options);
    ~Box2dPort() override;
    Box2dPort(const Box2dPort&) = delete;
    Box2dPort& operator=(const Box2dPort&) = delete;

    [[nodiscard]] step::Vec2 gravity() const override;
    [[nodiscard]] double unitsPerMetre() const override;
    /// Leaves out sensors, disabled bodies and fixtures whose mask is 0. Polygons come with their true faces, without
    /// Box2D's skin; chain ends are free corners even where ghost vertices were given (no edge exists there), one-sided
    /// single edges are joined to theirs.
    void query(const step::Box& box, std::vector<step::BodyOutline>& out) const override;
    [[nodiscard]] bool state(step::BodyId body, step::BodyState& out) const override;
    /// Contacts by the manifolds of the present poses (those the coming step will find) with the impulses of the last
    /// step; gear joints are left out (bridge/box2d/constraints.h).
    void constraints(const std::vector<step::BodyId>& seeds, double dt, step::HostConstraints& out) const override;
    void impulses(double dt, step::HostConstraints& io) const override;
    void applyImpulse(step::BodyId body, const step::Vec2& impulse, double angularImpulse) override;
    void setVelocity(step::BodyId body, const step::Vec2& velocity, double spin) override;
    void place(step::BodyId body, const step::Vec2& centre, double angle) override;
    void drive(step::BodyId body, const step::Vec2& centre, double angle, const step::Vec2& velocity,
               double spin) override;
    [[nodiscard]] step::BodyId find(const std::string& name) const override;
    /// Makes the bodies and joints in the world (scale of this port, not of the definition), names them for find(), and
    /// gives the world the definition's gravity.
    std::string build(const step::RigidWorldDefinition& definition) override;

    /// All outlines of all enabled bodies, sorted by (body, key).
    void everything(std::vector<step::BodyOutline>& out) const;
    /// The id of a body of this world; 0 if it is not one.
    [[nodiscard]] step::BodyId idOf(const b2Body& body) const;
    /// The body, or null when it no longer exists. Valid until the user destroys it.
    [[nodiscard]] b2Body* bodyOf(step::BodyId body) const;
    /// Names a body of this world for find(); a later body of the same name replaces the earlier one.
    void setName(const b2Body& body, const std::string& name);
    /// Tells that this body is about to be destroyed: its id dies here, whatever comes to its address.
    void forget(const b2Body& body);
    /// After world.Step(dt): tells how long it was (Box2D's impulses are of that step) and lets driven bodies be
    /// reported at the exact end of their motion (to the last double) instead of Box2D's rounded one. Optional.
    void stepped(double dt);

    [[nodiscard]] std::uint64_t refused() const;
    [[nodiscard]] const std::string& lastRefusal() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::bridge
