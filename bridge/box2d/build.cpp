#include "bridge/box2d/build.h"

#include "bridge/box2d/units.h"

#include <box2d/box2d.h>

namespace supercircle::bridge {

namespace {

using step::BodyDefinition;
using step::BodyType;
using step::FixtureDefinition;
using step::JointDefinition;
using step::JointKind;
using step::RigidWorldDefinition;
using step::ShapeKind;
using step::Vec2;

float toFloat(double v) {
    return static_cast<float>(v);
}

/// A two-sided chain is a row of Box2D's two-sided edges.
void addTwoSided(b2Body& body, b2FixtureDef& def, const std::vector<b2Vec2>& points, bool loop) {
    for (std::size_t i = 0; i + (loop ? 0 : 1) < points.size(); ++i) {
        const b2Vec2& next = points[(i + 1) % points.size()];
        if (points[i] == next) // a loop that repeats its first vertex
            continue;
        b2EdgeShape edge;
        edge.SetTwoSided(points[i], next);
        def.shape = &edge;
        body.CreateFixture(&def);
    }
}

void addFixture(b2Body& body, const FixtureDefinition& f, double scale) {
    b2FixtureDef def;
    def.density = toFloat(f.density / (scale * scale));
    def.friction = toFloat(f.friction);
    def.restitution = toFloat(f.restitution);
    def.isSensor = f.sensor;
    def.filter.categoryBits = f.filterCategoryBits;
    def.filter.maskBits = f.filterMaskBits;
    def.filter.groupIndex = f.filterGroupIndex;
    std::vector<b2Vec2> points;
    for (const Vec2& v : f.vertices)
        points.push_back(toHost(v, scale));
    const auto count = static_cast<int32>(points.size());
    if (f.twoSided && (f.shape == ShapeKind::Chain || f.shape == ShapeKind::Loop))
        return addTwoSided(body, def, points, f.shape == ShapeKind::Loop);

    b2CircleShape circle;
    b2PolygonShape polygon;
    b2ChainShape chain;
    switch (f.shape) {
    case ShapeKind::Circle:
        circle.m_p = toHost(f.centre, scale);
        circle.m_radius = toFloat(f.radius * scale);
        def.shape = &circle;
        break;
    case ShapeKind::Polygon:
        polygon.Set(points.data(), count);
        def.shape = &polygon;
        break;
    case ShapeKind::Chain: // the ghosts prolong the end edges: smooth ends for Box2D's own bodies
        chain.CreateChain(points.data(), count, points[0] + (points[0] - points[1]),
                          points[points.size() - 1] + (points[points.size() - 1] - points[points.size() - 2]));
        def.shape = &chain;
        break;
    case ShapeKind::Loop: {
        const bool repeated = points.front() == points.back();
        chain.CreateLoop(points.data(), repeated ? count - 1 : count);
        def.shape = &chain;
        break;
    }
    }
    body.CreateFixture(&def);
}

b2Body* addBody(b2World& world, const BodyDefinition& d, double scale) {
    b2BodyDef def;
    def.type = d.type == BodyType::Static      ? b2_staticBody
               : d.type == BodyType::Kinematic ? b2_kinematicBody
                                               : b2_dynamicBody;
    def.position = toHost(d.position, scale);
    def.angle = toFloat(d.angle);
    def.linearVelocity = toHost(d.linearVelocity, scale);
    def.angularVelocity = toFloat(d.angularVelocity);
    def.linearDamping = toFloat(d.linearDamping);
    def.angularDamping = toFloat(d.angularDamping);
    def.gravityScale = toFloat(d.gravityScale);
    def.bullet = d.bullet;
    def.fixedRotation = d.fixedRotation;
    def.allowSleep = d.allowSleep;
    def.awake = d.awake;
    def.enabled = d.active;
    b2Body* body = world.CreateBody(&def);
    for (const FixtureDefinition& f : d.fixtures)
        addFixture(*body, f, scale);
    if (d.massData && d.massData->mass > 0.0) { // exporters write 0 for bodies without mass data
        b2MassData mass;
        mass.mass = toFloat(d.massData->mass);
        mass.center = toHost(d.massData->centre, scale);
        mass.I = toFloat(d.massData->inertia * scale * scale);
        body->SetMassData(&mass);
    }
    return body;
}

/// Sets the common fields of all joints and creates the joint.
template <class Def>
b2Joint* create(b2World& world, Def& def, const JointDefinition& j, b2Body* a, b2Body* b) {
    def.bodyA = a;
    def.bodyB = b;
    def.collideConnected = j.collideConnected;
    return world.CreateJoint(&def);
}

template <class Def>
void anchors(Def& def, const JointDefinition& j, double scale) {
    def.localAnchorA = toHost(j.anchorA, scale);
    def.localAnchorB = toHost(j.anchorB, scale);
}

b2Joint* addRevolute(b2World& world, const JointDefinition& j, double scale, b2Body* a, b2Body* b) {
    b2RevoluteJointDef def;
    anchors(def, j, scale);
    def.referenceAngle = toFloat(j.refAngle);
    def.enableLimit = j.enableLimit;
    def.lowerAngle = toFloat(j.lowerLimit);
    def.upperAngle = toFloat(j.upperLimit);
    def.enableMotor = j.enableMotor;
    def.motorSpeed = toFloat(j.motorSpeed);
    def.maxMotorTorque = toFloat(j.maxMotorForce * scale * scale);
    return create(world, def, j, a, b);
}

b2Joint* addPrismatic(b2World& world, const JointDefinition& j, double scale, b2Body* a, b2Body* b) {
    b2PrismaticJointDef def;
    anchors(def, j, scale);
    def.localAxisA = toHost(j.localAxisA.normalized(), 1.0);
    def.referenceAngle = toFloat(j.refAngle);
    def.enableLimit = j.enableLimit;
    def.lowerTranslation = toFloat(j.lowerLimit * scale);
    def.upperTranslation = toFloat(j.upperLimit * scale);
    def.enableMotor = j.enableMotor;
    def.motorSpeed = toFloat(j.motorSpeed * scale);
    def.maxMotorForce = toFloat(j.maxMotorForce * scale);
    return create(world, def, j, a, b);
}

b2Joint* addDistance(b2World& world, const JointDefinition& j, double scale, b2Body* a, b2Body* b) {
    b2DistanceJointDef def;
    anchors(def, j, scale);
    def.length = toFloat(j.length * scale);
    // 2.4.1 is a rod when its least and greatest lengths are equal, else a spring between those limits.
    const bool rigid = j.frequency <= 0.0 && !j.enableLimit;
    def.minLength = rigid ? def.length : j.enableLimit ? toFloat(j.lowerLimit * scale) : 0.0F;
    def.maxLength = rigid ? def.length : j.enableLimit ? toFloat(j.upperLimit * scale) : b2_maxFloat;
    if (j.frequency > 0.0)
        b2LinearStiffness(def.stiffness, def.damping, toFloat(j.frequency), toFloat(j.dampingRatio), a, b);
    return create(world, def, j, a, b);
}

b2Joint* addWheel(b2World& world, const JointDefinition& j, double scale, b2Body* a, b2Body* b) {
    b2WheelJointDef def;
    anchors(def, j, scale);
    def.localAxisA = toHost(j.localAxisA.normalized(), 1.0);
    def.enableLimit = j.enableLimit;
    def.lowerTranslation = toFloat(j.lowerLimit * scale);
    def.upperTranslation = toFloat(j.upperLimit * scale);
    def.enableMotor = j.enableMotor;
    def.motorSpeed = toFloat(j.motorSpeed);
    def.maxMotorTorque = toFloat(j.maxMotorForce * scale * scale);
    if (j.frequency > 0.0)
        b2LinearStiffness(def.stiffness, def.damping, toFloat(j.frequency), toFloat(j.dampingRatio), a, b);
    return create(world, def, j, a, b);
}

b2Joint* addMouse(b2World& world, const JointDefinition& j, double scale, b2Body* a, b2Body* b) {
    b2MouseJointDef def;
    def.target = toHost(j.anchorB, scale); // the joint takes hold of this point ...
    def.maxForce = toFloat(j.maxMotorForce * scale);
    b2LinearStiffness(def.stiffness, def.damping, toFloat(j.frequency), toFloat(j.dampingRatio), a, b);
    b2Joint* joint = create(world, def, j, a, b);
    static_cast<b2MouseJoint*>(joint)->SetTarget(toHost(j.target, scale)); // ... and pulls it there
    return joint;
}

b2Joint* addPulley(b2World& world, const JointDefinition& j, double scale, b2Body* a, b2Body* b) {
    b2PulleyJointDef def;
    anchors(def, j, scale);
    def.groundAnchorA = toHost(j.groundAnchorA, scale);
    def.groundAnchorB = toHost(j.groundAnchorB, scale);
    def.lengthA = toFloat(j.lengthA * scale);
    def.lengthB = toFloat(j.lengthB * scale);
    def.ratio = toFloat(j.ratio);
    return create(world, def, j, a, b);
}

/// The joints of a gear exist already.
b2Joint* addGear(b2World& world, const JointDefinition& j, double scale, const RigidWorldDefinition& definition,
                 const std::vector<b2Joint*>& joints) {
    b2GearJointDef def;
    const auto one = static_cast<std::size_t>(j.joint1), two = static_cast<std::size_t>(j.joint2);
    def.joint1 = joints[one];
    def.joint2 = joints[two];
    // Box2D's ratio multiplies the second coordinate: a length in host units if that joint slides.
    const double unit1 = definition.joints[one].kind == JointKind::Prismatic ? scale : 1.0;
    const double unit2 = definition.joints[two].kind == JointKind::Prismatic ? scale : 1.0;
    def.ratio = toFloat(j.ratio * unit1 / unit2);
    return create(world, def, j, def.joint1->GetBodyB(), def.joint2->GetBodyB());
}

b2Joint* addJoint(b2World& world, const JointDefinition& j, double scale, const std::vector<b2Body*>& bodies) {
    b2Body* a = bodies[static_cast<std::size_t>(j.bodyA)];
    b2Body* b = bodies[static_cast<std::size_t>(j.bodyB)];
    switch (j.kind) {
    case JointKind::Revolute:
        return addRevolute(world, j, scale, a, b);
    case JointKind::Prismatic:
        return addPrismatic(world, j, scale, a, b);
    case JointKind::Distance:
        return addDistance(world, j, scale, a, b);
    case JointKind::Wheel:
        return addWheel(world, j, scale, a, b);
    case JointKind::Weld: {
        b2WeldJointDef def;
        anchors(def, j, scale);
        def.referenceAngle = toFloat(j.refAngle);
        if (j.frequency > 0.0)
            b2AngularStiffness(def.stiffness, def.damping, toFloat(j.frequency), toFloat(j.dampingRatio), a, b);
        return create(world, def, j, a, b);
    }
    case JointKind::Friction: {
        b2FrictionJointDef def;
        anchors(def, j, scale);
        def.maxForce = toFloat(j.maxMotorForce * scale);
        def.maxTorque = toFloat(j.maxTorque * scale * scale);
        return create(world, def, j, a, b);
    }
    case JointKind::Motor: {
        b2MotorJointDef def;
        def.linearOffset = toHost(j.anchorA, scale);
        def.angularOffset = toFloat(j.refAngle);
        def.maxForce = toFloat(j.maxMotorForce * scale);
        def.maxTorque = toFloat(j.maxTorque * scale * scale);
        def.correctionFactor = toFloat(j.correctionFactor);
        return create(world, def, j, a, b);
    }
    case JointKind::Mouse:
        return addMouse(world, j, scale, a, b);
    case JointKind::Pulley:
        return addPulley(world, j, scale, a, b);
    case JointKind::Gear: // needs the other joints: buildBodies
        break;
    }
    return nullptr;
}

} // namespace

std::vector<b2Body*> buildBodies(const RigidWorldDefinition& definition, b2World& world) {
    std::vector<b2Body*> bodies;
    for (const BodyDefinition& d : definition.bodies)
        bodies.push_back(addBody(world, d, definition.lengthScale));
    std::vector<b2Joint*> joints;
    for (const JointDefinition& j : definition.joints)
        joints.push_back(addJoint(world, j, definition.lengthScale, bodies));
    for (const JointDefinition& j : definition.joints)
        if (j.kind == JointKind::Gear)
            addGear(world, j, definition.lengthScale, definition, joints);
    return bodies;
}

} // namespace supercircle::bridge
