// Substeps. The core assumes that the host moves bodies by x += T v with the velocity at the end of the frame, as
// Box2D 2.4 does. Box2D 3 moves them in n substeps, each with the velocity of its own end. The same impulse then moves
// a falling body g T^2 (n - 1) / (2 n) less: 1 mm at 1/60 s and n = 4, two thicknesses of the paper's shell.
// applyImpulse() therefore sets the start velocity whose mean over the substeps is the velocity of the core.
// impulses(), the first call after the host's step, removes the excess velocity at the end. In that frame, contacts of
// the host see a start velocity that differs by up to g T / 2.

#include "bridge/box2d3/box2d3_port.h"

#include "bridge/box2d3/outlines.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace supercircle::box2d3 {

using step::BodyId;
using step::BodyOutline;
using step::BodyState;
using step::Box;
using step::Vec2;

namespace {

constexpr double kMaxHost = 1e7; // beyond it floats resolve less than a length unit; far below overflow

b2Vec2 toHost(const Vec2& v, double scale) {
    return {static_cast<float>(v.x() * scale), static_cast<float>(v.y() * scale)};
}

Vec2 toSi(const b2Vec2& v, double scale) {
    return {static_cast<double>(v.x) / scale, static_cast<double>(v.y) / scale};
}

b2Rot rotation(double angle) { // b2MakeRot is an approximation
    return {static_cast<float>(math::cos(angle)), static_cast<float>(math::sin(angle))};
}

bool fits(const Vec2& v, double scale) {
    return std::abs(v.x() * scale) < kMaxHost && std::abs(v.y() * scale) < kMaxHost; // false for NaN too
}

bool fitsFloat(double v) {
    return std::abs(v) < 1e30;
}

bool collect(b2ShapeId shape, void* context) {
    static_cast<std::vector<b2ShapeId>*>(context)->push_back(shape);
    return true;
}

/// Whether no other dynamic body touches it or is joined to it.
bool standsAlone(b2BodyId b) {
    if (b2Body_GetJointCount(b) > 0)
        return false;
    std::vector<b2ContactData> touching(static_cast<std::size_t>(b2Body_GetContactCapacity(b)));
    const int count = b2Body_GetContactData(b, touching.data(), static_cast<int>(touching.size()));
    return std::all_of(touching.begin(), touching.begin() + count, [&](const b2ContactData& c) {
        const b2BodyId first = b2Shape_GetBody(c.shapeIdA), second = b2Shape_GetBody(c.shapeIdB);
        return b2Body_GetType(B2_ID_EQUALS(first, b) ? second : first) != b2_dynamicBody;
    });
}

/// Effect of n substeps on a start velocity v: mean = keepMean v + addMean a, end = keepEnd v + addEnd a.
struct Substeps {
    double keepMean = 0.0, addMean = 0.0, keepEnd = 1.0, addEnd = 0.0;
    Substeps(double dt, int n, double damping) {
        const double h = dt / n, keep = 1.0 / (1.0 + h * damping);
        for (int k = 0; k < n; ++k) {
            keepEnd *= keep;
            addEnd = keep * addEnd + h;
            keepMean += keepEnd / n;
            addMean += addEnd / n;
        }
    }
};

/// An impulse applied before the host's step: the state before, the impulse of the core and the corrected one.
struct AppliedImpulse {
    BodyState before;
    Vec2 change = Vec2::Zero(); ///< impulse / mass, m/s
    double turn = 0.0;          ///< rad/s
    Vec2 corrected = Vec2::Zero();
    double correctedTurn = 0.0;
};

} // namespace

struct Box2d3Port::Impl {
    b2WorldId world{};
    double scale = 1.0;
    int substeps = 4;
    double dt = 0.0;                          ///< of the next host step, s; 0 = unknown
    std::map<BodyId, AppliedImpulse> applied; ///< since the last host step
    std::map<BodyId, double> angles;          ///< last reported angle, rad: Box2D's angles wrap at +-pi
    std::map<std::string, BodyId> names;
    std::uint64_t errorCount = 0;
    std::string lastError;

    void recordError(const std::string& why) {
        ++errorCount;
        lastError = why;
    }

    bool isValid() const { return b2World_IsValid(world); }

    /// The body, or a null id if it has been destroyed.
    b2BodyId body(BodyId id) const {
        const b2BodyId b = {static_cast<std::int32_t>(id >> 16), static_cast<std::uint16_t>(world.index1 - 1),
                            static_cast<std::uint16_t>(id & 0xffffu)};
        return (id >> 48) == 0 && isValid() && b.index1 > 0 && b2Body_IsValid(b) ? b : b2_nullBodyId;
    }

    /// The body if it exists and is dynamic; otherwise records an error and returns a null id.
    b2BodyId dynamic(BodyId id, const char* call) {
        const b2BodyId b = body(id);
        if (B2_IS_NULL(b))
            recordError(std::string(call) + ": the body no longer exists; the call is ignored");
        else if (b2Body_GetType(b) != b2_dynamicBody)
            recordError(std::string(call) + ": the body is not dynamic; the call is ignored");
        else
            return b;
        return b2_nullBodyId;
    }

    double angle(BodyId id, b2BodyId b) {
        const b2Rot q = b2Body_GetRotation(b);
        const double now = math::atan2(static_cast<double>(q.s), static_cast<double>(q.c));
        const auto [it, fresh] = angles.try_emplace(id, now);
        if (!fresh)
            it->second = now + 2.0 * std::numbers::pi * std::round((it->second - now) / (2.0 * std::numbers::pi));
        return it->second;
    }

    void setTransform(BodyId id, b2BodyId b, const b2Vec2& centre, double angle) {
        const b2Rot q = rotation(angle);
        b2Body_SetTransform(b, b2Sub(centre, b2RotateVector(q, b2Body_GetLocalCenterOfMass(b))), q);
        angles[id] = angle;
    }

    void append(const b2AABB& box, std::vector<BodyOutline>& out) const {
        std::vector<b2ShapeId> hits;
        b2QueryFilter all{};
        all.categoryBits = all.maskBits = UINT64_MAX;
        b2World_OverlapAABB(world, box, all, collect, &hits);
        const std::size_t first = out.size();
        for (const b2ShapeId shape : hits) {
            if (!isSolid(shape) || !b2AABB_Overlaps(b2Shape_GetAABB(shape), box)) // the tree's boxes are fattened
                continue;
            const b2BodyId b = b2Shape_GetBody(shape);
            BodyOutline o;
            o.local = outlineOf(shape, scale);
            o.body = idOf(b);
            o.friction = static_cast<double>(b2Shape_GetFriction(shape));
            out.push_back(std::move(o));
        }
        std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), step::before);
    }

    static BodyId idOf(b2BodyId b) { return static_cast<BodyId>(b.index1) << 16 | b.generation; }
};

Box2d3Port::Box2d3Port(b2WorldId world, const Options& options) : impl_(std::make_unique<Impl>()) {
    if (!b2World_IsValid(world))
        throw std::invalid_argument("Box2D 3: the world id is not valid");
    if (!std::isfinite(options.units_per_metre) || options.units_per_metre <= 0.0)
        throw std::invalid_argument("Box2D 3: units_per_metre must be finite and positive");
    if (options.substeps < 1)
        throw std::invalid_argument("Box2D 3: substeps must be at least 1");
    impl_->world = world;
    impl_->scale = options.units_per_metre;
    impl_->substeps = options.substeps;
}

Box2d3Port::~Box2d3Port() = default;

Vec2 Box2d3Port::gravity() const {
    return impl_->isValid() ? toSi(b2World_GetGravity(impl_->world), impl_->scale) : Vec2(Vec2::Zero());
}

double Box2d3Port::unitsPerMetre() const {
    return impl_->scale;
}

void Box2d3Port::query(const Box& box, std::vector<BodyOutline>& out) const {
    if (!impl_->isValid())
        return;
    if (!fits(box.lower, impl_->scale) || !fits(box.upper, impl_->scale)) {
        impl_->recordError("query: the box is not finite or too far away");
        return;
    }
    impl_->append({toHost(box.lower, impl_->scale), toHost(box.upper, impl_->scale)}, out);
}

/// Box2D 3 lists no bodies, so the box is enlarged by the farthest way that a body can have; what lies in it is read.
void Box2d3Port::queryAhead(std::span<const Box> boxes, double ahead, std::vector<BodyOutline>& out) const {
    if (!impl_->isValid() || boxes.empty())
        return;
    Box box = boxes.front(); // round all of them
    for (const Box& b : boxes) {
        box.lower = box.lower.cwiseMin(b.lower);
        box.upper = box.upper.cwiseMax(b.upper);
    }
    const double way = ahead * static_cast<double>(b2World_GetMaximumLinearSpeed(impl_->world)) / impl_->scale;
    query({box.lower - Vec2::Constant(way), box.upper + Vec2::Constant(way)}, out);
}

void Box2d3Port::everything(std::vector<BodyOutline>& out) const {
    constexpr auto kFar = static_cast<float>(kMaxHost);
    if (impl_->isValid())
        impl_->append({{-kFar, -kFar}, {kFar, kFar}}, out);
}

bool Box2d3Port::state(BodyId body, BodyState& out) const {
    const b2BodyId b = impl_->body(body);
    if (B2_IS_NULL(b)) {
        impl_->angles.erase(body);
        return false;
    }
    const double scale = impl_->scale;
    out = BodyState{};
    out.centre = toSi(b2Body_GetWorldCenterOfMass(b), scale);
    out.angle = impl_->angle(body, b);
    out.velocity = toSi(b2Body_GetLinearVelocity(b), scale);
    out.spin = static_cast<double>(b2Body_GetAngularVelocity(b));
    const b2BodyType type = b2Body_GetType(b);
    if (type == b2_dynamicBody) {
        out.mass = static_cast<double>(b2Body_GetMass(b));
        if (!b2Body_IsFixedRotation(b)) // GetRotationalInertia is about the centre of mass, unlike in 2.4
            out.inertia = static_cast<double>(b2Body_GetRotationalInertia(b)) / (scale * scale);
    }
    out.gravityScale = static_cast<double>(b2Body_GetGravityScale(b));
    out.linearDamping = static_cast<double>(b2Body_GetLinearDamping(b));
    out.angularDamping = static_cast<double>(b2Body_GetAngularDamping(b));
    out.awake = b2Body_IsAwake(b);
    out.enabled = b2Body_IsEnabled(b);
    out.moving = type != b2_staticBody;
    out.maySleep =
        type == b2_dynamicBody && b2World_IsSleepingEnabled(impl_->world) && b2Body_IsSleepEnabled(b) && standsAlone(b);
    return true;
}

void Box2d3Port::constraints(const std::vector<BodyId>&, double dt, step::HostConstraints&) const {
    impl_->dt = std::isfinite(dt) && dt > 0.0 ? dt : 0.0;
    impl_->applied.clear();
}

void Box2d3Port::impulses(double dt, step::HostConstraints&) const {
    const std::map<BodyId, AppliedImpulse> applied = std::exchange(impl_->applied, {});
    impl_->dt = 0.0;
    for (const auto& [id, h] : applied) {
        const b2BodyId b = impl_->body(id);
        if (B2_IS_NULL(b) || !b2Body_IsAwake(b))
            continue;
        const BodyState& s = h.before;
        const Vec2 g = s.gravityScale * gravity();
        const Substeps way(dt, impl_->substeps, s.linearDamping), turn(dt, impl_->substeps, s.angularDamping);
        const Vec2 meant = (s.velocity + h.change + dt * g) / (1.0 + dt * s.linearDamping);
        const Vec2 excess = way.keepEnd * (s.velocity + h.corrected) + way.addEnd * g - meant;
        const double excessTurn =
            turn.keepEnd * (s.spin + h.correctedTurn) - (s.spin + h.turn) / (1.0 + dt * s.angularDamping);
        b2Body_SetLinearVelocity(b, toHost(toSi(b2Body_GetLinearVelocity(b), impl_->scale) - excess, impl_->scale));
        b2Body_SetAngularVelocity(b,
                                  static_cast<float>(static_cast<double>(b2Body_GetAngularVelocity(b)) - excessTurn));
    }
}

void Box2d3Port::applyImpulse(BodyId body, const Vec2& impulse, double angularImpulse) {
    const double scale = impl_->scale;
    if (!fitsFloat(impulse.x() * scale) || !fitsFloat(impulse.y() * scale) ||
        !fitsFloat(angularImpulse * scale * scale)) {
        impl_->recordError("applyImpulse: the impulse is not finite or too large");
        return;
    }
    const b2BodyId b = impl_->dynamic(body, "applyImpulse");
    BodyState s;
    if (B2_IS_NULL(b) || !state(body, s) || !s.enabled || (impulse.isZero(0.0) && angularImpulse == 0.0))
        return; // a zero impulse does not wake a body
    Vec2 corrected = impulse;
    double correctedTurn = angularImpulse;
    const double dt = impl_->dt;
    if (dt > 0.0 && s.mass > 0.0 &&
        !impl_->applied.contains(body)) { // the impulse of the core in this frame: see the top of this file
        AppliedImpulse h;
        h.before = s;
        h.change = impulse / s.mass;
        h.turn = s.inertia > 0.0 ? angularImpulse / s.inertia : 0.0;
        const Vec2 g = s.gravityScale * gravity();
        const Substeps way(dt, impl_->substeps, s.linearDamping), turn(dt, impl_->substeps, s.angularDamping);
        const Vec2 mean = (s.velocity + h.change + dt * g) / (1.0 + dt * s.linearDamping);
        h.corrected = (mean - way.addMean * g) / way.keepMean - s.velocity;
        h.correctedTurn = (s.spin + h.turn) / (1.0 + dt * s.angularDamping) / turn.keepMean - s.spin;
        corrected = s.mass * h.corrected;
        correctedTurn = s.inertia * h.correctedTurn;
        impl_->applied[body] = h;
    }
    b2Body_ApplyLinearImpulseToCenter(b, toHost(corrected, scale), true);
    b2Body_ApplyAngularImpulse(b, static_cast<float>(correctedTurn * scale * scale), true);
}

void Box2d3Port::setVelocity(BodyId body, const Vec2& velocity, double spin) {
    if (!fits(velocity, impl_->scale) || !(std::abs(spin) < kMaxHost)) {
        impl_->recordError("setVelocity: the velocity is not finite or too large");
        return;
    }
    const b2BodyId b = impl_->dynamic(body, "setVelocity");
    if (B2_IS_NULL(b) || !b2Body_IsAwake(b))
        return;
    b2Body_SetLinearVelocity(b, toHost(velocity, impl_->scale));
    b2Body_SetAngularVelocity(b, static_cast<float>(spin));
}

void Box2d3Port::setAwake(BodyId body, bool awake) {
    const b2BodyId b = impl_->dynamic(body, "setAwake");
    if (B2_IS_NON_NULL(b) && b2Body_IsEnabled(b) && b2Body_IsAwake(b) != awake)
        b2Body_SetAwake(b, awake);
}

void Box2d3Port::place(BodyId body, const Vec2& centre, double angle) {
    if (!fits(centre, impl_->scale) || !(std::abs(angle) < kMaxHost)) {
        impl_->recordError("place: the pose is not finite or too far away");
        return;
    }
    const b2BodyId b = impl_->dynamic(body, "place");
    if (B2_IS_NULL(b))
        return;
    b2Vec2 way = b2Sub(toHost(centre, impl_->scale), b2Body_GetWorldCenterOfMass(b));
    std::vector<b2ContactData> touching(static_cast<std::size_t>(b2Body_GetContactCapacity(b)));
    const int count = b2Body_GetContactData(b, touching.data(), static_cast<int>(touching.size()));
    bool blocked = false;
    for (int i = 0; i < count; ++i) {
        const b2ContactData& c = touching[static_cast<std::size_t>(i)];
        const b2BodyId first = b2Shape_GetBody(c.shapeIdA), second = b2Shape_GetBody(c.shapeIdB);
        const bool isSecond = B2_ID_EQUALS(second, b);
        if (c.manifold.pointCount == 0 || b2Body_GetType(isSecond ? first : second) == b2_dynamicBody)
            continue;
        const b2Vec2 away = isSecond ? c.manifold.normal : b2Neg(c.manifold.normal);
        if (const float in = b2Dot(way, away); in < 0.0F) {
            way = b2MulSub(way, in, away);
            blocked = true;
        }
    }
    const double turned = blocked ? impl_->angle(body, b) : angle;
    impl_->setTransform(body, b, b2Add(b2Body_GetWorldCenterOfMass(b), way), turned);
}

void Box2d3Port::drive(BodyId body, const Vec2& centre, double angle, const Vec2& velocity, double spin) {
    if (!fits(centre, impl_->scale) || !fits(velocity, impl_->scale) || !(std::abs(angle) < kMaxHost) ||
        !(std::abs(spin) < kMaxHost)) {
        impl_->recordError("drive: the motion is not finite or too large");
        return;
    }
    const b2BodyId b = impl_->body(body);
    if (B2_IS_NULL(b) || b2Body_GetType(b) != b2_kinematicBody) {
        impl_->recordError(B2_IS_NULL(b) ? "drive: the body no longer exists; the call is ignored"
                                         : "drive: the body is not kinematic; only kinematic bodies can be driven");
        return;
    }
    impl_->setTransform(body, b, toHost(centre, impl_->scale), angle);
    b2Body_SetLinearVelocity(b, toHost(velocity, impl_->scale));
    b2Body_SetAngularVelocity(b, static_cast<float>(spin));
}

BodyId Box2d3Port::find(const std::string& name) const {
    const auto found = impl_->names.find(name);
    return found != impl_->names.end() && B2_IS_NON_NULL(impl_->body(found->second)) ? found->second : 0;
}

BodyId Box2d3Port::idOf(b2BodyId body) const {
    const BodyId id = Impl::idOf(body);
    return body.index1 > 0 && body.world0 + 1 == impl_->world.index1 && B2_IS_NON_NULL(impl_->body(id)) ? id : 0;
}

void Box2d3Port::setName(b2BodyId body, const std::string& name) {
    if (const BodyId id = idOf(body); id != 0)
        impl_->names[name] = id;
    else
        impl_->recordError("setName: '" + name + "' is not a body of this world");
}

std::uint64_t Box2d3Port::errorCount() const {
    return impl_->errorCount;
}

const std::string& Box2d3Port::lastError() const {
    return impl_->lastError;
}

Attachment attach(b2WorldId world, const Options& options) {
    auto port = std::make_shared<Box2d3Port>(world, options);
    Box2d3Port* const seen = port.get();
    return {std::move(port), seen};
}

void Attachment::set_name(b2BodyId body, const std::string& name) const {
    port_->setName(body, name);
}
std::uint64_t Attachment::body_id(b2BodyId body) const {
    return port_->idOf(body);
}
std::uint64_t Attachment::error_count() const {
    return port_->errorCount();
}
std::string Attachment::last_error() const {
    return port_->lastError();
}

} // namespace supercircle::box2d3
