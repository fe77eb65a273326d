#pragma once
// The narrow port through which the core sees the rigid world it lives in. The bridge implements it on Box2D, the tests
// on a fake. Everything crosses it in SI units and double precision; the length scale of the host stays behind it.

#include "supercircle/contact/geometry.h"
#include "supercircle/step/host_constraints.h"
#include "supercircle/support/failure.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace supercircle::step {

using rod::Vec2;
struct RigidWorldDefinition; // rigid_definition.h

/// Momentary state of a host body.
struct BodyState {
    Vec2 centre = Vec2::Zero();   ///< centre of mass, m
    double angle = 0.0;           ///< rad
    Vec2 velocity = Vec2::Zero(); ///< of the centre of mass, m/s
    double spin = 0.0;            ///< rad/s
    double mass = 0.0;            ///< kg; 0 = infinite (static and kinematic bodies)
    double inertia = 0.0;         ///< about the centre of mass, kg m^2; 0 = infinite (fixed rotation)
    double gravityScale = 1.0;    ///< 1
    double linearDamping = 0.0;   ///< 1/s
    double angularDamping = 0.0;  ///< 1/s
    bool awake = true;
    bool enabled = true;
    bool moving = false;   ///< kinematic or dynamic
    bool maySleep = false; ///< the host lets it sleep when setAwake asks for it
};

/// Stands for every fixture of a body.
inline constexpr std::uint32_t kAllFixtures = 0xffffffffU;

/// One solid piece of a host body, in the body's own frame (origin at its centre of mass, unrotated).
struct BodyOutline {
    contact::Outline local; ///< `body`, `motion` unused here; `key` is stable for this body, fixture and child
    BodyId body = 0;
    double friction = 0.0;     ///< of the fixture, 1; mixed with the shell's by sqrt(mu_a mu_b) unless a pair is set
    std::uint32_t fixture = 0; ///< which of the body's fixtures, 0 for the oldest
    bool operator==(const BodyOutline&) const = default;
};

/// The order of outlines: by body, then by key.
inline bool before(const BodyOutline& a, const BodyOutline& b) {
    return a.body != b.body ? a.body < b.body : a.local.key < b.local.key;
}

struct Box {
    Vec2 lower = Vec2::Zero(); ///< m
    Vec2 upper = Vec2::Zero(); ///< m
};

/// A body that the host's step carried elsewhere than foreseen.
struct StrayBody {
    BodyId body = 0;
    Vec2 centre = Vec2::Zero(); ///< foreseen centre of mass, m
    double angle = 0.0;         ///< rad
};

class Port {
public:
    virtual ~Port() = default;
    /// Gravity of the host world, m/s^2.
    [[nodiscard]] virtual Vec2 gravity() const = 0;
    /// Host length units per metre (only for messages and pictures).
    [[nodiscard]] virtual double unitsPerMetre() const = 0;
    /// Appends the outlines whose boxes meet `box` (sensors left out), sorted by (body, key).
    virtual void query(const Box& box, std::vector<BodyOutline>& out) const = 0;
    /// Appends the outlines that meet one of the boxes now or within the coming `ahead` s as their bodies move by
    /// themselves, sorted by (body, key). Bodies that may move come with all their outlines.
    virtual void queryAhead(std::span<const Box> boxes, double ahead, std::vector<BodyOutline>& out) const = 0;
    /// False when the body no longer exists.
    [[nodiscard]] virtual bool state(BodyId body, BodyState& out) const = 0;
    /// Appends the host's own constraints on these bodies and on all dynamic ones they lead to: points of touching
    /// contacts, rows of joints. `dt` is the coming host step, s (a soft joint's damping depends on it).
    virtual void constraints(const std::vector<BodyId>&, double /*dt*/, HostConstraints&) const {}
    /// After the host's step of `dt` s: fills in the impulses its solver found for constraints listed before the step.
    virtual void impulses(double /*dt*/, HostConstraints&) const {}
    /// Adds an impulse (N s) and an angular impulse about the centre of mass (N m s); wakes the body.
    virtual void applyImpulse(BodyId body, const Vec2& impulse, double angularImpulse) = 0;
    /// Sets the velocity of the centre of mass and the spin of a dynamic body after a host step, m/s and rad/s; wakes
    /// nobody.
    virtual void setVelocity(BodyId body, const Vec2& velocity, double spin) = 0;
    /// Puts a body to sleep, at rest, or wakes it; between steps of the host. Hosts that leave BodyState::maySleep
    /// false need not know how.
    virtual void setAwake(BodyId /*body*/, bool /*awake*/) {}
    /// Moves a dynamic body after a host step without a change of velocity, as far as immovable bodies it touches let
    /// it.
    virtual void place(BodyId body, const Vec2& centre, double angle) = 0;
    /// The same to where a shell holds it, whatever it touches: as far as it could have come there within the frame.
    virtual void putBack(BodyId body, const Vec2& centre, double angle) { place(body, centre, angle); }
    /// Before its step of `ahead` s: notes where dynamic bodies will be if only gravity changes their motion.
    virtual void foresee(double /*ahead*/) {}
    /// After its step: appends the dynamic bodies that met one of the boxes on the straight way from where they were
    /// foreseen to where they are, without those of `known` (sorted), and all their outlines, sorted by (body, key).
    /// Bodies farther away than the step can take them were put there by their user, and are left out.
    virtual void strayed(std::span<const BodyId> /*known*/, std::span<const Box>, std::vector<StrayBody>&,
                         std::vector<BodyOutline>&) const {}
    /// Places a kinematic body for the coming host step: pose at its start and velocity through it.
    virtual void drive(BodyId body, const Vec2& centre, double angle, const Vec2& velocity, double spin) = 0;
    /// Makes bodies, fixtures and joints in the host, names them for find() and sets the host's gravity. Empty, or why
    /// nothing was made.
    [[nodiscard]] virtual std::string build(const RigidWorldDefinition&) { return "this host cannot be given bodies"; }
    /// Moves the origin of the host's coordinates to `by` (m, in the old frame). Empty, or why it did not.
    [[nodiscard]] virtual std::string shiftOrigin(const Vec2& /*by*/) { return "this host cannot shift its origin"; }
    /// A message for the user about what shells do not take from the host; each is given once. Empty: none.
    [[nodiscard]] virtual std::string takeNote() const { return {}; }
    /// The body called `name` in the host, 0 if there is none.
    [[nodiscard]] virtual BodyId find(const std::string& name) const = 0;
};

/// A host world the program itself owns and advances (the `supercircle` program, tests).
class HostWorld : public Port {
public:
    /// One step of the host's own solver, s.
    virtual void step(double dt) = 0;
    /// All outlines of all bodies, for pictures; local frames as in BodyOutline.
    virtual void everything(std::vector<BodyOutline>& out) const = 0;
    /// Puts a kinematic body back into a state that state() gave, to the last bit.
    virtual void put(BodyId body, const BodyState& state) {
        drive(body, state.centre, state.angle, state.velocity, state.spin);
    }
    /// State of a body that this program made and has not removed.
    [[nodiscard]] BodyState stateOf(BodyId body) const {
        BodyState found;
        const bool known = state(body, found);
        SC_ASSERT(known, "a body of the program's own world has a state");
        return found;
    }
};

} // namespace supercircle::step
