// The rows are those of Box2D 2.4.1's own velocity solver (b2_*_joint.cpp). Soft rows use its implicit softness
// gamma = 1 / (dt (damping + dt stiffness)), bias = C dt stiffness gamma, written as
// force - (damping + dt stiffness) v.

#include "bridge/box2d/constraints.h"

#include <algorithm>
#include <cmath>

namespace supercircle::bridge {

using rod::cross;
using rod::perp;
using step::BodyId;
using step::HostContact;
using step::HostRow;
using step::HostRowKind;
using step::Vec2;

namespace {

Vec2 toDouble(const b2Vec2& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y)};
}

/// The bodies of a joint and the rows between them, in SI units.
class JointRows {
public:
    JointRows(const BodyRegistry& registry, b2Joint& joint, double scale, double dt, double lastDt,
              std::vector<HostRow>& out)
        : a_(joint.GetBodyA()), b_(joint.GetBodyB()), idA_(registry.id(a_)), idB_(registry.id(b_)), scale_(scale),
          dt_(dt), inverseLast_(lastDt > 0.0 ? static_cast<float>(1.0 / lastDt) : 0.0F),
          force_(toDouble(joint.GetReactionForce(inverseLast_)) / scale),
          torque_(static_cast<double>(joint.GetReactionTorque(inverseLast_)) / (scale * scale)), out_(out) {}

    void add(b2Joint& joint);

private:
    [[nodiscard]] Vec2 armA(const b2Vec2& anchor) const {
        return toDouble(b2Mul(a_->GetTransform().q, anchor - a_->GetLocalCenter())) / scale_;
    }
    [[nodiscard]] Vec2 armB(const b2Vec2& anchor) const {
        return toDouble(b2Mul(b_->GetTransform().q, anchor - b_->GetLocalCenter())) / scale_;
    }
    [[nodiscard]] Vec2 apart() const { return toDouble(b_->GetWorldCenter() - a_->GetWorldCenter()) / scale_; }
    HostRow& row(const Vec2& axisA, double turnA, const Vec2& axisB, double turnB, double last) {
        HostRow r;
        r.a = idA_;
        r.b = idB_;
        r.axisA = axisA;
        r.turnA = turnA;
        r.axisB = axisB;
        r.turnB = turnB;
        r.last = last;
        out_.push_back(r);
        return out_.back();
    }
    /// Along `axis` at points with these arms.
    HostRow& along(const Vec2& axis, const Vec2& rA, const Vec2& rB) {
        return row(-axis, -cross(rA, axis), axis, cross(rB, axis), force_.dot(axis));
    }
    HostRow& angular(double last) { return row(Vec2::Zero(), -1.0, Vec2::Zero(), 1.0, last); }
    void point(const Vec2& rA, const Vec2& rB) {
        along(Vec2::UnitX(), rA, rB);
        along(Vec2::UnitY(), rA, rB);
    }
    void soften(HostRow& r, double error, double stiffness, double damping) const {
        r.kind = HostRowKind::Soft;
        r.force = -stiffness * error;
        r.damping = damping + dt_ * stiffness;
    }
    static void motor(HostRow& r, double speed, double strength, double last) {
        r.speed = speed;
        r.strength = strength;
        r.last = last;
        r.saturated = std::abs(last) < 0.99 * strength ? 0 : last > 0.0 ? 1 : -1;
    }
    /// Both limits of a coordinate whose row is `r` (a copy: `out_` grows).
    void limits(HostRow r, double value, double lower, double upper) {
        r.kind = HostRowKind::Limit;
        r.strength = std::numeric_limits<double>::infinity();
        r.saturated = 0;
        const double last = r.last;
        r.clearance = std::max(0.0, value - lower);
        r.last = std::max(0.0, last);
        out_.push_back(r);
        r.axisA = -r.axisA;
        r.axisB = -r.axisB;
        r.turnA = -r.turnA;
        r.turnB = -r.turnB;
        r.clearance = std::max(0.0, upper - value);
        r.last = std::max(0.0, -last);
        out_.push_back(r);
    }

    void revolute(b2RevoluteJoint& j);
    void prismatic(b2PrismaticJoint& j);
    void distance(b2DistanceJoint& j);
    void weld(b2WeldJoint& j);
    void wheel(b2WheelJoint& j);
    void friction(b2FrictionJoint& j);
    void motorJoint(b2MotorJoint& j);
    void mouse(b2MouseJoint& j);
    void pulley(b2PulleyJoint& j);

    b2Body* a_;
    b2Body* b_;
    BodyId idA_, idB_;
    double scale_, dt_;
    float inverseLast_;
    Vec2 force_;    ///< on b in the last step, N
    double torque_; ///< N m
    std::vector<HostRow>& out_;
};

void JointRows::revolute(b2RevoluteJoint& j) {
    point(armA(j.GetLocalAnchorA()), armB(j.GetLocalAnchorB()));
    const double squared = scale_ * scale_;
    const double motorTorque = j.IsMotorEnabled() ? static_cast<double>(j.GetMotorTorque(inverseLast_)) / squared : 0.0;
    if (j.IsMotorEnabled())
        motor(angular(0.0), static_cast<double>(j.GetMotorSpeed()),
              static_cast<double>(j.GetMaxMotorTorque()) / squared, motorTorque);
    if (j.IsLimitEnabled()) {
        HostRow r = angular(torque_ - motorTorque);
        out_.pop_back();
        limits(r, static_cast<double>(j.GetJointAngle()), static_cast<double>(j.GetLowerLimit()),
               static_cast<double>(j.GetUpperLimit()));
    }
}

void JointRows::prismatic(b2PrismaticJoint& j) {
    const Vec2 rA = armA(j.GetLocalAnchorA()), rB = armB(j.GetLocalAnchorB());
    const Vec2 d = apart() + rB - rA;
    const Vec2 axis = toDouble(b2Mul(a_->GetTransform().q, j.GetLocalAxisA()));
    along(perp(axis), d + rA, rB);
    angular(torque_);
    const double motorForce = j.IsMotorEnabled() ? static_cast<double>(j.GetMotorForce(inverseLast_)) / scale_ : 0.0;
    if (j.IsMotorEnabled())
        motor(along(axis, d + rA, rB), static_cast<double>(j.GetMotorSpeed()) / scale_,
              static_cast<double>(j.GetMaxMotorForce()) / scale_, motorForce);
    if (j.IsLimitEnabled()) {
        HostRow r = along(axis, d + rA, rB);
        out_.pop_back();
        r.last -= motorForce;
        limits(r, d.dot(axis), static_cast<double>(j.GetLowerLimit()) / scale_,
               static_cast<double>(j.GetUpperLimit()) / scale_);
    }
}

void JointRows::distance(b2DistanceJoint& j) {
    const Vec2 rA = armA(j.GetLocalAnchorA()), rB = armB(j.GetLocalAnchorB());
    const Vec2 d = apart() + rB - rA;
    const double length = d.norm();
    if (length * scale_ <= static_cast<double>(b2_linearSlop))
        return; // no direction, as in Box2D
    const Vec2 axis = d / length;
    const double lower = static_cast<double>(j.GetMinLength()) / scale_;
    const double upper = static_cast<double>(j.GetMaxLength()) / scale_;
    if (!(lower < upper)) {
        along(axis, rA, rB);
        return;
    }
    if (j.GetStiffness() > 0.0F)
        soften(along(axis, rA, rB), length - static_cast<double>(j.GetLength()) / scale_,
               static_cast<double>(j.GetStiffness()), static_cast<double>(j.GetDamping()));
    HostRow r = along(axis, rA, rB);
    out_.pop_back();
    if (j.GetStiffness() > 0.0F)
        r.last = 0.0; // the force belongs to the spring's row
    limits(r, length, lower, upper);
}

void JointRows::weld(b2WeldJoint& j) {
    point(armA(j.GetLocalAnchorA()), armB(j.GetLocalAnchorB()));
    HostRow& r = angular(torque_);
    const double squared = scale_ * scale_;
    if (j.GetStiffness() > 0.0F)
        soften(r, static_cast<double>(b_->GetAngle() - a_->GetAngle() - j.GetReferenceAngle()),
               static_cast<double>(j.GetStiffness()) / squared, static_cast<double>(j.GetDamping()) / squared);
}

void JointRows::wheel(b2WheelJoint& j) {
    const Vec2 rA = armA(j.GetLocalAnchorA()), rB = armB(j.GetLocalAnchorB());
    const Vec2 d = apart() + rB - rA;
    const Vec2 axis = toDouble(b2Mul(a_->GetTransform().q, j.GetLocalAxisA()));
    along(perp(axis), d + rA, rB);
    if (j.GetStiffness() > 0.0F)
        soften(along(axis, d + rA, rB), d.dot(axis), static_cast<double>(j.GetStiffness()),
               static_cast<double>(j.GetDamping()));
    if (j.IsMotorEnabled()) {
        const double squared = scale_ * scale_;
        motor(angular(0.0), static_cast<double>(j.GetMotorSpeed()),
              static_cast<double>(j.GetMaxMotorTorque()) / squared,
              static_cast<double>(j.GetMotorTorque(inverseLast_)) / squared);
    }
    if (j.IsLimitEnabled()) {
        HostRow r = along(axis, d + rA, rB);
        out_.pop_back();
        r.last = 0.0; // cannot be separated from the spring's force
        limits(r, d.dot(axis), static_cast<double>(j.GetLowerLimit()) / scale_,
               static_cast<double>(j.GetUpperLimit()) / scale_);
    }
}

void JointRows::friction(b2FrictionJoint& j) {
    const Vec2 rA = armA(j.GetLocalAnchorA()), rB = armB(j.GetLocalAnchorB());
    const double force = static_cast<double>(j.GetMaxForce()) / scale_;
    // Box2D limits the magnitude of the force: rows along its last direction and across.
    const bool known = force_.norm() > 1e-6 * force;
    const Vec2 axis = known ? Vec2(force_.normalized()) : Vec2::UnitX();
    HostRow& first = along(axis, rA, rB);
    motor(first, 0.0, force, first.last);
    HostRow& second = along(perp(axis), rA, rB);
    motor(second, 0.0, force, second.last);
    motor(angular(0.0), 0.0, static_cast<double>(j.GetMaxTorque()) / (scale_ * scale_), torque_);
}

void JointRows::motorJoint(b2MotorJoint& j) {
    const Vec2 rA = armA(j.GetLinearOffset()), rB = armB({0.0F, 0.0F});
    const double factor = static_cast<double>(j.GetCorrectionFactor()) / dt_;
    const Vec2 error = apart() + rB - rA;
    const double force = static_cast<double>(j.GetMaxForce()) / scale_;
    for (const Vec2& axis : {Vec2(Vec2::UnitX()), Vec2(Vec2::UnitY())}) {
        HostRow& r = along(axis, rA, rB);
        motor(r, -factor * error.dot(axis), force, r.last);
    }
    motor(angular(0.0), -factor * static_cast<double>(b_->GetAngle() - a_->GetAngle() - j.GetAngularOffset()),
          static_cast<double>(j.GetMaxTorque()) / (scale_ * scale_), torque_);
}

void JointRows::mouse(b2MouseJoint& j) {
    const Vec2 rB = toDouble(j.GetAnchorB() - b_->GetWorldCenter()) / scale_;
    const Vec2 error = toDouble(j.GetAnchorB() - j.GetTarget()) / scale_;
    const double stiffness = static_cast<double>(j.GetStiffness()), damping = static_cast<double>(j.GetDamping());
    const double strength = static_cast<double>(j.GetMaxForce()) / scale_;
    for (const Vec2& axis : {Vec2(Vec2::UnitX()), Vec2(Vec2::UnitY())}) {
        HostRow& r = row(Vec2::Zero(), 0.0, axis, cross(rB, axis), force_.dot(axis));
        r.a = 0;
        soften(r, error.dot(axis), stiffness, damping);
        if (stiffness * error.norm() > strength || force_.norm() >= 0.99 * strength) { // at its largest force: constant
            r.damping = 0.0;
            r.force = -strength * error.dot(axis) / std::max(error.norm(), 1e-12);
        }
    }
}

void JointRows::pulley(b2PulleyJoint& j) {
    const Vec2 toA = toDouble(j.GetAnchorA() - j.GetGroundAnchorA()),
               toB = toDouble(j.GetAnchorB() - j.GetGroundAnchorB());
    const double least = 10.0 * static_cast<double>(b2_linearSlop);
    if (toA.norm() < least || toB.norm() < least)
        return;
    const Vec2 uA = toA.normalized(), uB = static_cast<double>(j.GetRatio()) * toB.normalized();
    const Vec2 rA = toDouble(j.GetAnchorA() - a_->GetWorldCenter()) / scale_;
    const Vec2 rB = toDouble(j.GetAnchorB() - b_->GetWorldCenter()) / scale_;
    // The joint's reaction is its impulse along uB without the ratio, with opposite sign.
    row(-uA, -cross(rA, uA), -uB, -cross(rB, uB), force_.dot(uB) / uB.norm());
}

void JointRows::add(b2Joint& joint) {
    switch (joint.GetType()) {
    case e_revoluteJoint:
        return revolute(static_cast<b2RevoluteJoint&>(joint));
    case e_prismaticJoint:
        return prismatic(static_cast<b2PrismaticJoint&>(joint));
    case e_distanceJoint:
        return distance(static_cast<b2DistanceJoint&>(joint));
    case e_weldJoint:
        return weld(static_cast<b2WeldJoint&>(joint));
    case e_wheelJoint:
        return wheel(static_cast<b2WheelJoint&>(joint));
    case e_frictionJoint:
        return friction(static_cast<b2FrictionJoint&>(joint));
    case e_motorJoint:
        return motorJoint(static_cast<b2MotorJoint&>(joint));
    case e_mouseJoint:
        return mouse(static_cast<b2MouseJoint&>(joint));
    case e_pulleyJoint:
        return pulley(static_cast<b2PulleyJoint&>(joint));
    default:
        return;
    }
}

void appendJoint(const BodyRegistry& registry, b2Joint& joint, double scale, double dt, double lastDt,
                 std::vector<HostRow>& out) {
    const std::size_t first = out.size();
    JointRows(registry, joint, scale, dt, lastDt, out).add(joint);
    for (std::size_t i = first; i < out.size(); ++i)
        out[i].key = static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(&joint));
}

/// Relative velocity of b at a point.
Vec2 relativeVelocity(const b2Body& a, const b2Body& b, const b2Vec2& at) {
    return toDouble(b.GetLinearVelocityFromWorldPoint(at) - a.GetLinearVelocityFromWorldPoint(at));
}

/// Distinguishes the points of one body pair. Addresses of fixtures serve as names only, not as an order.
std::uint64_t keyOf(b2Contact& contact, const b2ManifoldPoint& point) {
    const auto name = [](const void* p) { return static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(p)); };
    std::uint64_t key = name(contact.GetFixtureA()) * 0x9E3779B97F4A7C15ULL + name(contact.GetFixtureB());
    for (const std::uint64_t part :
         {static_cast<std::uint64_t>(contact.GetChildIndexA()), static_cast<std::uint64_t>(contact.GetChildIndexB()),
          static_cast<std::uint64_t>(point.id.key)})
        key = (key ^ part) * 0xBF58476D1CE4E5B9ULL;
    return key;
}

/// The manifold of the next step, with the impulses of the points that persist. The contact itself still has the
/// manifold of the last step's start.
b2Manifold presentManifold(b2Contact& contact) {
    b2Manifold m{};
    contact.Evaluate(&m, contact.GetFixtureA()->GetBody()->GetTransform(),
                     contact.GetFixtureB()->GetBody()->GetTransform());
    const b2Manifold& old = *contact.GetManifold();
    for (int32 i = 0; i < m.pointCount; ++i) {
        m.points[i].normalImpulse = m.points[i].tangentImpulse = 0.0F;
        for (int32 k = 0; k < (contact.IsTouching() ? old.pointCount : 0); ++k)
            if (old.points[k].id.key == m.points[i].id.key) {
                m.points[i].normalImpulse = old.points[k].normalImpulse;
                m.points[i].tangentImpulse = old.points[k].tangentImpulse;
            }
    }
    return m;
}

/// Returns false if the shapes do not touch.
bool appendContact(const BodyRegistry& registry, b2Contact& contact, double scale, double lastDt,
                   std::vector<HostContact>& out) {
    const b2Manifold manifold = presentManifold(contact);
    b2Fixture &fixtureA = *contact.GetFixtureA(), &fixtureB = *contact.GetFixtureB();
    b2Body &a = *fixtureA.GetBody(), &b = *fixtureB.GetBody();
    b2WorldManifold world;
    world.Initialize(&manifold, a.GetTransform(), fixtureA.GetShape()->m_radius, b.GetTransform(),
                     fixtureB.GetShape()->m_radius);
    const double perTime = lastDt > 0.0 ? 1.0 / (lastDt * scale) : 0.0;
    for (int32 i = 0; i < manifold.pointCount; ++i) {
        HostContact c;
        c.key = keyOf(contact, manifold.points[i]);
        c.point = manifold.points[i].id.key;
        c.a = registry.id(&a);
        c.b = registry.id(&b);
        c.armA = toDouble(world.points[i] - a.GetWorldCenter()) / scale;
        c.armB = toDouble(world.points[i] - b.GetWorldCenter()) / scale;
        c.normal = toDouble(world.normal).normalized();
        c.friction = static_cast<double>(contact.GetFriction());
        c.tangentSpeed = -static_cast<double>(contact.GetTangentSpeed()) / scale; // its tangent is -perp(normal)
        const double approach = -relativeVelocity(a, b, world.points[i]).dot(toDouble(world.normal));
        if (approach > static_cast<double>(contact.GetRestitutionThreshold()))
            c.restitutionVelocity = static_cast<double>(contact.GetRestitution()) * approach / scale;
        c.normalForce = std::max(0.0, static_cast<double>(manifold.points[i].normalImpulse)) * perTime;
        c.tangentForce = -static_cast<double>(manifold.points[i].tangentImpulse) * perTime;
        out.push_back(c);
    }
    return manifold.pointCount > 0;
}

void readImpulse(b2Contact& contact, double scale, HostContact& c) {
    const b2Manifold& m = *contact.GetManifold();
    b2ManifoldPoint point{};
    point.id.key = c.point;
    if (keyOf(contact, point) != c.key || !contact.IsEnabled())
        return;
    for (int32 i = 0; i < m.pointCount && !c.impulseKnown; ++i) {
        if (m.points[i].id.key != c.point)
            continue;
        c.hostNormal = static_cast<double>(m.points[i].normalImpulse) / scale;
        c.hostTangent = -static_cast<double>(m.points[i].tangentImpulse) / scale;
        c.impulseKnown = contact.IsTouching();
    }
    c.impulseUnknown = !c.impulseKnown; // continuous collision within the step has replaced the manifold
}

/// Returns false if the id is in the list already.
bool insertSorted(std::vector<BodyId>& ids, BodyId id) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), id);
    if (at != ids.end() && *at == id)
        return false;
    ids.insert(at, id);
    return true;
}

} // namespace

bool pushes(const b2Contact& contact) {
    return contact.IsEnabled() && !contact.GetFixtureA()->IsSensor() && !contact.GetFixtureB()->IsSensor();
}

bool isBlocked(const b2Body& body, b2Vec2& displacement) {
    bool blocked = false;
    for (const b2ContactEdge* e = body.GetContactList(); e != nullptr; e = e->next) {
        if (e->other->GetType() == b2_dynamicBody || !e->contact->IsTouching() || !pushes(*e->contact))
            continue;
        b2WorldManifold manifold;
        e->contact->GetWorldManifold(&manifold);
        const b2Vec2 out = e->contact->GetFixtureB()->GetBody() == &body ? manifold.normal : -manifold.normal;
        if (const float in = b2Dot(displacement, out); in < 0.0F) {
            displacement -= in * out;
            blocked = true;
        }
    }
    return blocked;
}

void appendConstraints(const BodyRegistry& registry, const std::vector<BodyId>& seeds, double unitsPerMetre, double dt,
                       double lastDt, ConstraintWorkspace& work, step::HostConstraints& out) {
    out.farthest = static_cast<double>(b2_maxTranslation) / unitsPerMetre;
    out.mostTurn = static_cast<double>(b2_maxRotation);
    std::vector<BodyId>& found = work.found; // in the order of the search; `in` has them sorted
    std::vector<BodyId>&in = work.in, &done = work.done;
    found.clear();
    in.clear();
    done.clear();
    for (const BodyId id : seeds) {
        found.push_back(id);
        insertSorted(in, id);
    }
    const auto visit = [&](const b2Body* body) {
        if (const BodyId id = registry.id(body); id != 0 && insertSorted(in, id))
            found.push_back(id);
    };
    const auto isDone = [&](const b2Body* body) {
        return std::binary_search(done.begin(), done.end(), registry.id(body));
    };
    // A constraint is appended at the first of its bodies.
    for (std::size_t i = 0; i < found.size(); ++i) {
        b2Body* body = registry.body(found[i]);
        if (body == nullptr || body->GetType() != b2_dynamicBody || !body->IsEnabled())
            continue;
        for (b2ContactEdge* e = body->GetContactList(); e != nullptr; e = e->next) {
            if (!pushes(*e->contact) || isDone(e->other))
                continue;
            if (appendContact(registry, *e->contact, unitsPerMetre, lastDt, out.contacts))
                visit(e->other);
        }
        for (b2JointEdge* e = body->GetJointList(); e != nullptr; e = e->next) {
            if (!e->joint->IsEnabled() || isDone(e->other))
                continue;
            appendJoint(registry, *e->joint, unitsPerMetre, dt, lastDt, out.rows);
            visit(e->other);
        }
        insertSorted(done, found[i]);
    }
}

void readImpulses(const BodyRegistry& registry, double unitsPerMetre, double dt, ConstraintWorkspace& work,
                  step::HostConstraints& io) {
    for (HostContact& c : io.contacts) {
        b2Body *a = registry.body(c.a), *b = registry.body(c.b);
        for (b2ContactEdge* e = a && b ? a->GetContactList() : nullptr; e != nullptr && !c.impulseKnown; e = e->next)
            if (e->other == b)
                readImpulse(*e->contact, unitsPerMetre, c);
    }
    std::vector<HostRow>& now = work.rows;
    for (std::size_t i = 0, next = 0; i < io.rows.size(); i = next) {
        while (next < io.rows.size() && io.rows[next].key == io.rows[i].key)
            ++next;
        now.clear();
        bool turned = false;
        b2Body* body = registry.body(io.rows[i].b);
        for (b2JointEdge* e = body ? body->GetJointList() : nullptr; e != nullptr; e = e->next)
            if (io.rows[i].key == static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(e->joint))) {
                appendJoint(registry, *e->joint, unitsPerMetre, dt, dt, now);
                turned = e->joint->GetType() == e_frictionJoint; // its rows follow its force
            }
        for (std::size_t k = i; k < next && now.size() == next - i; ++k) {
            HostRow& row = io.rows[k];
            row.host = now[k - i].last * dt;
            if (turned && !row.axisB.isZero(0.0))
                row.host = dt * (now[0].last * now[0].axisB + now[1].last * now[1].axisB).dot(row.axisB);
            row.impulseKnown = true;
        }
    }
}

} // namespace supercircle::bridge
