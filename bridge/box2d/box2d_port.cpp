// Box2D's floats are the reference for bodies that it moves itself. The motion of a driven (kinematic) body is known in
// double precision by its owner, while Box2D rounds to about 1e-7 of the distance from the origin. At a plate speed of
// 5 mm/s and steps of 0.1 ms this is several per cent of the displacement of one step. The port therefore remembers the
// exact pose and reports it as long as Box2D's pose is its rounded value.

#include "bridge/box2d/box2d_port.h"

#include "bridge/box2d/body_registry.h"
#include "bridge/box2d/build.h"
#include "bridge/box2d/constraints.h"
#include "bridge/box2d/foreseen_bodies.h"
#include "bridge/box2d/free_way.h"
#include "bridge/box2d/outline_query.h"
#include "bridge/box2d/outlines.h"
#include "bridge/box2d/rigid_check.h"
#include "bridge/box2d/units.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

namespace supercircle::bridge {

using step::BodyId;
using step::BodyOutline;
using step::BodyState;
using step::Box;
using step::Vec2;

namespace {

/// Largest coordinate, velocity, angle and spin that Box2D is given, in its units: floats of that size are 1 apart.
constexpr double kMaxHost = 1e7;

/// A body moved by drive(): the exact motion and Box2D's rounded pose.
struct Driven {
    Vec2 centre = Vec2::Zero();    ///< m
    double angle = 0.0;            ///< rad
    Vec2 velocity = Vec2::Zero();  ///< m/s
    double spin = 0.0;             ///< rad/s
    b2Vec2 hostCentre{0.0F, 0.0F}; ///< Box2D units
    float hostAngle = 0.0F;        ///< rad
};

/// A call of applyImpulse() or drive() that came while the world was locked.
struct Deferred {
    BodyId body = 0;
    bool isDrive = false;
    Vec2 linear = Vec2::Zero(); ///< impulse, N s; of drive() velocity, m/s
    double angular = 0.0;       ///< angular impulse, N m s; of drive() spin, rad/s
    Vec2 centre = Vec2::Zero(); ///< of drive(), m
    double angle = 0.0;         ///< of drive(), rad
};

bool fits(const Vec2& v, double scale) {
    return std::abs(v.x() * scale) < kMaxHost && std::abs(v.y() * scale) < kMaxHost; // false for NaN too
}

/// Impulses are not rounded against a place: it is enough that they are far from the largest float, 3e38.
bool fitsFloat(double v) {
    return std::abs(v) < 1e30;
}

} // namespace

struct Box2dPort::Impl {
    b2World* world = nullptr;
    double scale = 1.0;
    BodyRegistry registry;
    std::map<std::string, BodyId> names;
    std::map<BodyId, Driven> driven;
    std::vector<Deferred> deferred;
    double lastDt = 0.0; ///< of the host's last step if known, s; else 0
    std::uint64_t errorCount = 0;
    std::string lastError;
    bool restitutionNoted = false;
    std::string note;              ///< for takeNote()
    OutlineQuery outlineQuery;     ///< storage of query()
    std::vector<b2AABB> hostBoxes; ///< likewise
    ForeseenBodies foreseen;
    ConstraintWorkspace constraintWorkspace; ///< storage of constraints() and impulses()

    void recordError(const std::string& why) {
        ++errorCount;
        lastError = why;
    }

    /// Updates the body registry, then does the deferred work if the world is unlocked.
    void sync(bool thorough) {
        if (thorough)
            registry.sync(*world);
        else
            registry.syncIfChanged(*world);
        if (world->IsLocked() || deferred.empty())
            return;
        const std::vector<Deferred> work = std::exchange(deferred, {});
        for (const Deferred& d : work) {
            if (d.isDrive)
                drive(d.body, d.centre, d.angle, d.linear, d.angular);
            else
                applyImpulse(d.body, d.linear, d.angular);
        }
    }

    /// The body `id` if it is dynamic and the world is not locked; else null, with an error that names the `call`.
    b2Body* dynamicBody(BodyId id, const char* call) {
        b2Body* b = registry.body(id);
        if (b != nullptr && b->GetType() == b2_dynamicBody && !world->IsLocked())
            return b;
        recordError(std::string(call) + ": the body is not dynamic, no longer exists, or the world is locked");
        return nullptr;
    }

    /// The same for a new pose, after a sync; null as well if the pose is not finite or too far away.
    b2Body* placeable(BodyId id, const Vec2& centre, double angle, const char* call) {
        sync(false);
        if (fits(centre, scale) && std::abs(angle) < kMaxHost)
            return dynamicBody(id, call);
        recordError(std::string(call) + ": the pose is not finite or too far away");
        return nullptr;
    }

    void applyImpulse(BodyId id, const Vec2& impulse, double angular) {
        b2Body* b = registry.body(id);
        if (b == nullptr) {
            recordError("applyImpulse: the body no longer exists; the call is ignored");
            return;
        }
        if (!b->IsEnabled() || (impulse.isZero(0.0) && angular == 0.0))
            return; // a zero impulse does not wake a body
        b->ApplyLinearImpulseToCenter(toHost(impulse, scale), true);
        b->ApplyAngularImpulse(static_cast<float>(angular * scale * scale), true);
    }

    /// False, with an error, if a motion is not finite or too large for floats.
    bool isMotion(const Vec2& centre, double angle, const Vec2& velocity, double spin, const char* call) {
        if (fits(centre, scale) && fits(velocity, scale) && std::abs(angle) < kMaxHost && std::abs(spin) < kMaxHost)
            return true;
        recordError(std::string(call) + ": the motion is not finite or too large");
        return false;
    }

    /// Gives a kinematic body this pose and velocity. Null, with an error, if there is no such body.
    b2Body* placeKinematic(BodyId id, const Vec2& centre, double angle, const Vec2& velocity, double spin) {
        b2Body* b = registry.body(id);
        if (b == nullptr || b->GetType() != b2_kinematicBody) {
            recordError(b == nullptr ? "drive: the body no longer exists; the call is ignored"
                                     : "drive: the body is not kinematic; only kinematic bodies can be driven");
            return nullptr;
        }
        moveTo(*b, toHost(centre, scale), static_cast<float>(angle));
        b->SetLinearVelocity(toHost(velocity, scale));
        b->SetAngularVelocity(static_cast<float>(spin));
        return b;
    }

    void drive(BodyId id, const Vec2& centre, double angle, const Vec2& velocity, double spin) {
        if (const b2Body* b = placeKinematic(id, centre, angle, velocity, spin))
            driven[id] = {centre, angle, velocity, spin, b->GetWorldCenter(), b->GetAngle()};
    }

    /// Puts the exact pose and velocity of a driven body into `out`, as far as Box2D has their rounded values.
    void reportExactMotion(BodyId id, const b2Body& body, BodyState& out) const {
        const auto found = driven.find(id);
        if (found == driven.end())
            return;
        const Driven& d = found->second;
        if (body.GetWorldCenter() == d.hostCentre && body.GetAngle() == d.hostAngle) {
            out.centre = d.centre;
            out.angle = d.angle;
        }
        if (body.GetLinearVelocity() == toHost(d.velocity, scale) &&
            body.GetAngularVelocity() == static_cast<float>(d.spin)) {
            out.velocity = d.velocity;
            out.spin = d.spin;
        }
    }

    /// Syncs, and fills hostBoxes: the boxes in Box2D units without those that are not finite or too far away.
    void findBoxes(std::span<const Box> boxes, bool thorough = true) {
        sync(thorough);
        hostBoxes.clear();
        for (const Box& box : boxes)
            if (fits(box.lower, scale) && fits(box.upper, scale))
                hostBoxes.push_back({toHost(box.lower, scale), toHost(box.upper, scale)});
            else
                recordError("query: the box is not finite or too far away");
    }

    /// Leaves a message for takeNote() where a fixture has a restitution, once a world.
    void noteRestitution(const std::vector<Piece>& pieces) {
        if (restitutionNoted)
            return;
        for (const Piece& p : pieces)
            if (p.fixture->GetRestitution() > 0.0F) {
                restitutionNoted = true;
                note = "restitution of fixtures is ignored by shells: how high a shell bounces follows from its own "
                       "elasticity (docs/how-to/rigid_bodies_and_limits.md)";
                return;
            }
    }

    /// Appends the outlines of the pieces in the order (body id, key).
    void append(const std::vector<Piece>& pieces, std::vector<BodyOutline>& out) {
        noteRestitution(pieces);
        const std::size_t first = out.size();
        for (const Piece& p : pieces) {
            BodyOutline o;
            o.local = outlineOf(*p.fixture, p.child, scale, p.key());
            o.body = registry.id(p.body);
            o.friction = static_cast<double>(p.fixture->GetFriction());
            o.fixture = fixtureNumber(*p.fixture);
            out.push_back(std::move(o));
        }
        std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), step::before);
    }
};

Box2dPort::Box2dPort(b2World& world, const Options& options) : impl_(std::make_unique<Impl>()) {
    if (!std::isfinite(options.units_per_metre) || options.units_per_metre <= 0.0)
        throw std::invalid_argument("bridge: units_per_metre must be finite and positive");
    impl_->world = &world;
    impl_->scale = options.units_per_metre;
    impl_->registry.sync(world);
}

Box2dPort::~Box2dPort() = default;

Vec2 Box2dPort::gravity() const {
    return toSi(impl_->world->GetGravity(), impl_->scale);
}

double Box2dPort::unitsPerMetre() const {
    return impl_->scale;
}

void Box2dPort::query(const Box& box, std::vector<BodyOutline>& out) const {
    impl_->findBoxes({&box, 1});
    if (!impl_->hostBoxes.empty())
        impl_->append(impl_->outlineQuery.now(*impl_->world, impl_->hostBoxes.front()), out);
}

void Box2dPort::queryAhead(std::span<const Box> boxes, double ahead, std::vector<BodyOutline>& out) const {
    impl_->findBoxes(boxes);
    if (!impl_->hostBoxes.empty())
        impl_->append(impl_->outlineQuery.ahead(*impl_->world, impl_->hostBoxes, ahead), out);
}

void Box2dPort::everything(std::vector<BodyOutline>& out) const {
    impl_->sync(true);
    impl_->append(impl_->outlineQuery.all(*impl_->world), out);
}

bool Box2dPort::state(BodyId body, BodyState& out) const {
    impl_->sync(false);
    const b2Body* b = impl_->registry.body(body);
    if (b == nullptr)
        return false;
    const double scale = impl_->scale;
    out = BodyState{};
    out.centre = toSi(b->GetWorldCenter(), scale);
    out.angle = static_cast<double>(b->GetAngle());
    out.velocity = toSi(b->GetLinearVelocity(), scale);
    out.spin = static_cast<double>(b->GetAngularVelocity());
    if (b->GetType() == b2_dynamicBody) {
        out.mass = static_cast<double>(b->GetMass());
        if (!b->IsFixedRotation()) {
            // GetInertia is about the body origin.
            const Vec2 c = toSi(b->GetLocalCenter(), 1.0);
            out.inertia =
                std::max(0.0, static_cast<double>(b->GetInertia()) - out.mass * c.squaredNorm()) / (scale * scale);
        }
    }
    out.gravityScale = static_cast<double>(b->GetGravityScale());
    out.linearDamping = static_cast<double>(b->GetLinearDamping());
    out.angularDamping = static_cast<double>(b->GetAngularDamping());
    out.awake = b->IsAwake();
    out.enabled = b->IsEnabled();
    out.moving = b->GetType() != b2_staticBody;
    out.maySleep = b->IsSleepingAllowed() && impl_->world->GetAllowSleeping();
    impl_->reportExactMotion(body, *b, out);
    return true;
}

void Box2dPort::constraints(const std::vector<BodyId>& seeds, double dt, step::HostConstraints& out) const {
    impl_->sync(false);
    appendConstraints(impl_->registry, seeds, impl_->scale, dt, impl_->lastDt > 0.0 ? impl_->lastDt : dt,
                      impl_->constraintWorkspace, out);
}

void Box2dPort::impulses(double dt, step::HostConstraints& io) const {
    impl_->sync(true);
    impl_->lastDt = dt;
    readImpulses(impl_->registry, impl_->scale, dt, impl_->constraintWorkspace, io);
}

void Box2dPort::applyImpulse(BodyId body, const Vec2& impulse, double angularImpulse) {
    impl_->sync(false);
    const double scale = impl_->scale;
    if (!fitsFloat(impulse.x() * scale) || !fitsFloat(impulse.y() * scale) ||
        !fitsFloat(angularImpulse * scale * scale)) {
        impl_->recordError("applyImpulse: the impulse is not finite or too large");
        return;
    }
    if (impl_->world->IsLocked()) {
        impl_->deferred.push_back({.body = body, .linear = impulse, .angular = angularImpulse});
        return;
    }
    impl_->applyImpulse(body, impulse, angularImpulse);
}

void Box2dPort::setVelocity(BodyId body, const Vec2& velocity, double spin) {
    impl_->sync(false);
    if (!fits(velocity, impl_->scale) || !(std::abs(spin) < kMaxHost)) {
        impl_->recordError("setVelocity: the velocity is not finite or too large");
        return;
    }
    b2Body* b = impl_->dynamicBody(body, "setVelocity");
    if (b == nullptr || !b->IsAwake())
        return;
    b->SetLinearVelocity(toHost(velocity, impl_->scale));
    b->SetAngularVelocity(static_cast<float>(spin));
}

void Box2dPort::setAwake(BodyId body, bool awake) {
    impl_->sync(false);
    if (b2Body* b = impl_->registry.body(body); b != nullptr && b->IsAwake() != awake)
        b->SetAwake(awake);
}

void Box2dPort::place(BodyId body, const Vec2& centre, double angle) {
    if (b2Body* b = impl_->placeable(body, centre, angle, "place"))
        moveAsFar(*b, toHost(centre, impl_->scale), static_cast<float>(angle), impl_->outlineQuery);
}

void Box2dPort::putBack(BodyId body, const Vec2& centre, double angle) {
    if (b2Body* b = impl_->placeable(body, centre, angle, "putBack"))
        moveBack(*b, toHost(centre, impl_->scale), static_cast<float>(angle), impl_->foreseen, impl_->outlineQuery);
}

void Box2dPort::foresee(double ahead) {
    impl_->sync(false);
    impl_->foreseen.note(*impl_->world, impl_->registry, static_cast<float>(ahead));
}

void Box2dPort::strayed(std::span<const BodyId> known, std::span<const Box> boxes, std::vector<step::StrayBody>& strays,
                        std::vector<BodyOutline>& out) const {
    impl_->findBoxes(boxes, false); // impulses() has looked at every body
    const std::size_t first = out.size();
    impl_->foreseen.forStrays(impl_->registry, known, [&](const ForeseenBodies::Pose& from, const Motion& way) {
        const std::vector<Piece>& pieces = impl_->outlineQuery.onWay(*from.body, way, impl_->hostBoxes);
        if (pieces.empty())
            return;
        strays.push_back({from.id, toSi(from.centre, impl_->scale), static_cast<double>(from.angle)});
        impl_->append(pieces, out);
    });
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), step::before);
}

void Box2dPort::drive(BodyId body, const Vec2& centre, double angle, const Vec2& velocity, double spin) {
    impl_->sync(false);
    if (!impl_->isMotion(centre, angle, velocity, spin, "drive"))
        return;
    if (impl_->world->IsLocked()) {
        impl_->deferred.push_back({body, true, velocity, spin, centre, angle});
        return;
    }
    impl_->drive(body, centre, angle, velocity, spin);
}

void Box2dPort::put(BodyId body, const BodyState& state) {
    impl_->sync(false);
    if (impl_->world->IsLocked())
        impl_->recordError("put: the world is locked");
    else if (impl_->isMotion(state.centre, state.angle, state.velocity, state.spin, "put"))
        impl_->placeKinematic(body, state.centre, state.angle, state.velocity, state.spin);
}

BodyId Box2dPort::find(const std::string& name) const {
    impl_->sync(false);
    const auto found = impl_->names.find(name);
    return found != impl_->names.end() && impl_->registry.body(found->second) != nullptr ? found->second : 0;
}

std::string Box2dPort::build(const step::RigidWorldDefinition& definition) {
    if (impl_->world->IsLocked())
        return "bodies cannot be built inside the world's own step";
    step::RigidWorldDefinition scaled = definition;
    scaled.lengthScale = impl_->scale;
    if (std::string why = checkDefinition(scaled); !why.empty())
        return why;
    impl_->world->SetGravity(toHost(scaled.gravity, scaled.lengthScale));
    const std::vector<b2Body*> bodies = buildBodies(scaled, *impl_->world);
    impl_->registry.sync(*impl_->world);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        if (!scaled.bodies[i].name.empty())
            setName(*bodies[i], scaled.bodies[i].name);
    return {};
}

std::string Box2dPort::shiftOrigin(const Vec2& by) {
    if (impl_->world->IsLocked())
        return "the origin cannot be shifted inside the world's own step";
    if (!fits(by, impl_->scale))
        return "the new origin is not finite or too far away";
    impl_->sync(true);
    std::vector<BodyId> exact; // those whose motion is known in double precision
    for (const auto& [id, d] : impl_->driven)
        if (const b2Body* b = impl_->registry.body(id); b != nullptr && b->GetWorldCenter() == d.hostCentre)
            exact.push_back(id);
    impl_->world->ShiftOrigin(toHost(by, impl_->scale));
    for (const BodyId id : exact) {
        impl_->driven[id].centre -= by;
        impl_->driven[id].hostCentre = impl_->registry.body(id)->GetWorldCenter();
    }
    return {};
}

std::string Box2dPort::takeNote() const {
    return std::exchange(impl_->note, {});
}

std::uint32_t Box2dPort::fixtureNumber(const b2Fixture& fixture) {
    std::uint32_t older = 0; // the list starts with the newest
    for (const b2Fixture* f = fixture.GetNext(); f != nullptr; f = f->GetNext())
        ++older;
    return older;
}

b2Fixture* Box2dPort::fixtureOf(BodyId body, std::uint32_t fixture) const {
    b2Body* b = bodyOf(body);
    for (b2Fixture* f = b != nullptr ? b->GetFixtureList() : nullptr; f != nullptr; f = f->GetNext())
        if (fixtureNumber(*f) == fixture)
            return f;
    return nullptr;
}

BodyId Box2dPort::idOf(const b2Body& body) const {
    impl_->sync(false);
    return impl_->registry.id(&body);
}

b2Body* Box2dPort::bodyOf(BodyId body) const {
    impl_->sync(false);
    return impl_->registry.body(body);
}

void Box2dPort::setName(const b2Body& body, const std::string& name) {
    if (const BodyId id = idOf(body); id != 0)
        impl_->names[name] = id;
    else
        impl_->recordError("setName: '" + name + "' is not a body of this world");
}

void Box2dPort::notifyDestroyed(const b2Body& body) {
    impl_->registry.notifyDestroyed(&body);
}

void Box2dPort::stepped(double dt) {
    impl_->lastDt = dt;
    impl_->sync(false);
    for (auto it = impl_->driven.begin(); it != impl_->driven.end();) {
        const b2Body* b = impl_->registry.body(it->first);
        if (b == nullptr) {
            it = impl_->driven.erase(it);
            continue;
        }
        Driven& d = it->second;
        const Vec2 centre = d.centre + dt * d.velocity;
        const double angle = d.angle + dt * d.spin;
        // Box2D limits the displacement of one step, and the user may have moved the body: then its pose is correct.
        // Floats are rounded to 6e-8 of the place, some times in a step.
        const double rounding = 1e-6 * (1.0 + impl_->scale * (centre.cwiseAbs().maxCoeff() + d.centre.norm()));
        const Vec2 off = toSi(b->GetWorldCenter(), 1.0) - impl_->scale * centre;
        const bool arrived = off.cwiseAbs().maxCoeff() < rounding &&
                             std::abs(static_cast<double>(b->GetAngle()) - angle) < 1e-6 * (1.0 + std::abs(angle));
        if (!arrived) {
            it = impl_->driven.erase(it);
            continue;
        }
        d.centre = centre;
        d.angle = angle;
        d.hostCentre = b->GetWorldCenter();
        d.hostAngle = b->GetAngle();
        ++it;
    }
}

std::uint64_t Box2dPort::errorCount() const {
    return impl_->errorCount;
}

const std::string& Box2dPort::lastError() const {
    return impl_->lastError;
}

} // namespace supercircle::bridge
