#pragma once
// The core's port on a Box2D 2.4.1 world that belongs to the user. Here float and double meet, and nowhere else.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "supercircle/step/port.h"
#include "supercircle/step/rigid_definition.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::bridge {

/// A step::Port on a b2World. It keeps a pointer to the world, which must outlive it. No other pointer is dereferenced
/// before the world's body list has confirmed it.
///
/// Scales, with L = units_per_metre: lengths, velocities, gravity, forces and impulses times L; inertia, torque and
/// angular impulse times L^2; mass, time and angles as they are.
///
/// Body ids. Box2D does not report the destruction of a body and reuses its address. Ids rely on the order of creation
/// in which the world keeps its bodies: a body whose position in that order changed is a new one. One case needs more:
/// the youngest body is destroyed and another one is created at its address. It is distinguished by type, user data,
/// mass, inertia and fixtures. If all of these agree, the new body inherits the id; its pose and velocity are read
/// anew. Call notifyDestroyed() where that matters. query() notices destroyed bodies; the other calls notice them when
/// the world's body count or youngest body differ.
///
/// Locked world (inside its callbacks): reading works; applyImpulse and drive are deferred, in order, to the first call
/// of the port after the world is unlocked; setVelocity, place and putBack are invalid calls.
///
/// Invalid calls (non-finite values, drive on a body that is not kinematic) do not reach Box2D, which would abort. Such
/// a call changes nothing; errorCount() counts it and lastError() gives the reason.
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
    void queryAhead(std::span<const step::Box> boxes, double ahead, std::vector<step::BodyOutline>& out) const override;
    [[nodiscard]] bool state(step::BodyId body, step::BodyState& out) const override;
    /// Contacts by the manifolds of the present poses (those the next step will find) with the impulses of the last
    /// step; gear joints are left out (bridge/box2d/constraints.h).
    void constraints(const std::vector<step::BodyId>& seeds, double dt, step::HostConstraints& out) const override;
    void impulses(double dt, step::HostConstraints& io) const override;
    void applyImpulse(step::BodyId body, const step::Vec2& impulse, double angularImpulse) override;
    void setVelocity(step::BodyId body, const step::Vec2& velocity, double spin) override;
    void setAwake(step::BodyId body, bool awake) override;
    void place(step::BodyId body, const step::Vec2& centre, double angle) override;
    void putBack(step::BodyId body, const step::Vec2& centre, double angle) override;
    void foresee(double ahead) override;
    void strayed(std::span<const step::BodyId> known, std::span<const step::Box> boxes,
                 std::vector<step::StrayBody>& strays, std::vector<step::BodyOutline>& out) const override;
    void drive(step::BodyId body, const step::Vec2& centre, double angle, const step::Vec2& velocity,
               double spin) override;
    /// As of step::HostWorld. An invalid call while the world is locked.
    void put(step::BodyId body, const step::BodyState& state);
    [[nodiscard]] step::BodyId find(const std::string& name) const override;
    /// Creates the bodies and joints in the world (scale of this port, not of the definition), names them for find(),
    /// and sets the world's gravity.
    std::string build(const step::RigidWorldDefinition& definition) override;
    /// b2World::ShiftOrigin; not inside the world's callbacks.
    std::string shiftOrigin(const step::Vec2& by) override;
    /// Restitution of a fixture near shells, once a world.
    [[nodiscard]] std::string takeNote() const override;

    /// All outlines of all enabled bodies, sorted by (body, key).
    void everything(std::vector<step::BodyOutline>& out) const;
    /// The id of a body of this world; 0 if it is not one.
    [[nodiscard]] step::BodyId idOf(const b2Body& body) const;
    /// The body, or null if it has been destroyed. Valid until the user destroys it.
    [[nodiscard]] b2Body* bodyOf(step::BodyId body) const;
    /// The fixture of a body by its number from the oldest (step::BodyOutline::fixture), or null.
    [[nodiscard]] b2Fixture* fixtureOf(step::BodyId body, std::uint32_t fixture) const;
    /// Its number.
    [[nodiscard]] static std::uint32_t fixtureNumber(const b2Fixture& fixture);
    /// Names a body of this world for find(); a later body of the same name replaces the earlier one.
    void setName(const b2Body& body, const std::string& name);
    /// Call this before destroying a body: its id ends here, whatever is created at its address.
    void notifyDestroyed(const b2Body& body);
    /// After world.Step(dt), dt in s: Box2D's impulses are those of this step. Driven bodies are then reported at the
    /// exact end of their motion in double precision instead of Box2D's rounded one. Optional.
    void stepped(double dt);

    [[nodiscard]] std::uint64_t errorCount() const;
    [[nodiscard]] const std::string& lastError() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::bridge
