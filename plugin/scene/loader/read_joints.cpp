// Joints between rigid bodies under the names of R.U.B.E. and b2dJson.

#include "plugin/scene/loader/sections.h"

#include <algorithm>

namespace supercircle::scene {

namespace {

using rod::Vec2;
using step::JointDefinition;
using step::JointKind;
using step::RigidWorldDefinition;

/// The words of "type". A rope is a distance joint of Box2D 2.4 with a largest length only.
const std::vector<std::string> kJointKinds = {"revolute", "prismatic", "distance", "weld",  "wheel", "friction",
                                              "motor",    "pulley",    "gear",     "mouse", "rope"};

void readMotor(ObjectReader& reader, JointDefinition& j) {
    j.enableLimit = reader.boolean("enableLimit", false);
    j.lowerLimit = reader.number("lowerLimit", 0.0);
    j.upperLimit = reader.number("upperLimit", 0.0);
    j.enableMotor = reader.boolean("enableMotor", false);
    j.motorSpeed = reader.number("motorSpeed", 0.0);
    const bool turns = j.kind == JointKind::Revolute || j.kind == JointKind::Wheel;
    reader.ignore({"maxMotorTorque", "maxMotorForce", "maxForce"});
    if (j.kind == JointKind::Friction || j.kind == JointKind::Motor || j.kind == JointKind::Mouse) {
        j.maxMotorForce = reader.number("maxForce", 0.0, notNegative);
        j.maxTorque = reader.number("maxTorque", 0.0, notNegative);
    } else {
        j.maxMotorForce = reader.number(turns ? "maxMotorTorque" : "maxMotorForce", 0.0, notNegative);
    }
}

/// "spring": in metres, or in radians of a revolute joint.
void readSpring(Context& context, const Node& node, const std::string& pointer, JointDefinition& j) {
    ObjectReader reader(context, node, pointer);
    if (!reader.valid())
        return;
    const bool turns = j.kind == JointKind::Revolute;
    j.spring.stiffness = reader.number(turns ? "stiffness_N_m_rad" : "stiffness_N_m", 0.0);
    j.spring.cubic = reader.number(turns ? "cubic_1_rad2" : "cubic_1_m2", 0.0);
    j.spring.viscosity = reader.number(turns ? "viscosity_N_m_s_rad" : "viscosity_N_s_m", 0.0, notNegative);
    j.spring.rest = reader.number(turns ? "rest_rad" : "rest_m", 0.0);
    reader.finish();
}

/// "friction": a torque of a revolute joint, a coefficient and a normal force of a prismatic one.
void readFriction(Context& context, const Node& node, const std::string& pointer, JointDefinition& j) {
    ObjectReader reader(context, node, pointer);
    if (!reader.valid())
        return;
    if (j.kind == JointKind::Revolute) {
        j.friction.sliding = reader.number("torque_N_m", 0.0, notNegative);
        j.friction.sticking = reader.number("static_torque_N_m", j.friction.sliding, notNegative);
    } else {
        const double normal = reader.number("normal_force_N", 0.0, notNegative);
        const double sliding = reader.number("coefficient", 0.0, notNegative);
        j.friction.sliding = sliding * normal;
        j.friction.sticking = normal * reader.number("static_coefficient", sliding, notNegative);
        reader.require("normal_force_N", "the force that presses the surfaces together, N");
    }
    reader.finish();
    if (j.friction.sticking < j.friction.sliding)
        context.error(node, pointer, "friction at rest below that of sliding", "a static value that is not smaller");
}

/// What acts along the free motion of a joint.
void readMechanics(Context& context, ObjectReader& reader, JointDefinition& j) {
    const bool slides = j.kind == JointKind::Prismatic, turns = j.kind == JointKind::Revolute;
    const auto misplaced = [&](const Node& node, const char* key, const char* expected) {
        context.error(node, reader.pointerTo(key), "this type of joint takes none", expected);
    };
    if (const std::optional<Node> spring = reader.find("spring")) {
        if (slides || turns || j.kind == JointKind::Distance)
            readSpring(context, *spring, reader.pointerTo("spring"), j);
        else
            misplaced(*spring, "spring", "a spring of a revolute, prismatic or distance joint");
    }
    if (const std::optional<Node> friction = reader.find("friction")) {
        if (slides || turns)
            readFriction(context, *friction, reader.pointerTo("friction"), j);
        else
            misplaced(*friction, "friction", "the friction of a revolute or prismatic joint");
    }
}

void readBodies(Context& context, ObjectReader& reader, std::size_t bodies, JointDefinition& j) {
    const std::size_t before = context.errors();
    for (const char* key : {"bodyA", "bodyB"}) {
        reader.require(key, "the index of a body");
        const auto index = static_cast<std::int32_t>(reader.integer(key, 0, 0, 1000000));
        if (const std::optional<Node> node = reader.find(key); node && static_cast<std::size_t>(index) >= bodies)
            context.error(*node, reader.pointerTo(key), "there is no body " + std::to_string(index),
                          "an index into \"body\", which counts from 0 and has " + std::to_string(bodies) +
                              (bodies == 1 ? " item" : " items"));
        (key[4] == 'A' ? j.bodyA : j.bodyB) = index;
    }
    if (reader.valid() && context.errors() == before && (bodies < 2 || j.bodyA == j.bodyB))
        context.error(reader.node(), reader.pointer(), "the joint does not join two bodies",
                      "two different body indices");
}

void readPlace(Context& context, ObjectReader& reader, JointDefinition& j) {
    j.anchorA = reader.vector("anchorA", j.anchorA);
    j.anchorB = reader.vector("anchorB", j.anchorB);
    if (j.kind == JointKind::Motor) // the name since R.U.B.E. 1.7; exports before have the offset in "anchorA"
        j.anchorA = reader.vector("linearOffset", j.anchorA);
    j.localAxisA = reader.vector("localAxisA", reader.vector("localAxis1", j.localAxisA));
    if (j.localAxisA.norm() > 0.0)
        j.localAxisA.normalize();
    else
        context.error(reader.node(), reader.pointer(), "the axis has no direction", "a vector other than 0");
    j.refAngle = reader.number("refAngle", 0.0);
    const bool unitLength = j.kind == JointKind::Distance && !context.rubeExport;
    j.length = reader.number("length", unitLength ? 1.0 : 0.0, notNegative);
}

void readRope(ObjectReader& reader, JointDefinition& j) {
    reader.require("maxLength", "a number > 0, m");
    j.enableLimit = true;
    j.lowerLimit = 0.0;
    j.upperLimit = j.length = reader.number("maxLength", 1.0, positive);
}

void readPulley(Context& context, ObjectReader& reader, JointDefinition& j) {
    j.groundAnchorA = reader.vector("groundAnchorA", Vec2::Zero());
    j.groundAnchorB = reader.vector("groundAnchorB", Vec2::Zero());
    j.lengthA = reader.number("lengthA", 0.0, notNegative);
    j.lengthB = reader.number("lengthB", 0.0, notNegative);
    j.ratio = reader.number("ratio", context.rubeExport ? 0.0 : 1.0);
    if (!(j.ratio > 0.0))
        context.error(reader.node(), reader.pointer(), "the pulley has no ratio", "\"ratio\" > 0");
}

void readMouse(Context& context, ObjectReader& reader, JointDefinition& j) {
    j.target = reader.vector("target", Vec2::Zero());
    if (!(j.frequency > 0.0))
        context.error(reader.node(), reader.pointer(), "the mouse joint has no spring", "\"frequency\" > 0, Hz");
}

void readGear(Context& context, ObjectReader& reader, std::size_t joints, JointDefinition& j) {
    const auto last = static_cast<std::int64_t>(joints) - 1;
    for (const char* key : {"joint1", "joint2"}) {
        reader.require(key, "the index of a revolute or prismatic joint");
        (key[5] == '1' ? j.joint1 : j.joint2) = static_cast<std::int32_t>(reader.integer(key, 0, 0, last));
    }
    j.ratio = reader.number("ratio", context.rubeExport ? 0.0 : 1.0);
}

/// What Box2D asserts of the two joints of a gear.
void checkGear(Context& context, const ArrayItem& place, const RigidWorldDefinition& world, const JointDefinition& j) {
    const auto& one = world.joints[static_cast<std::size_t>(j.joint1)];
    const auto& two = world.joints[static_cast<std::size_t>(j.joint2)];
    for (const JointDefinition* part : {&one, &two}) {
        if (part->kind != JointKind::Revolute && part->kind != JointKind::Prismatic) {
            context.error(place.node, place.pointer, "the gear joins joints of another type",
                          "\"joint1\" and \"joint2\" of type \"revolute\" or \"prismatic\"");
            return;
        }
        if (world.bodies[static_cast<std::size_t>(part->bodyB)].type != step::BodyType::Dynamic) {
            context.error(place.node, place.pointer, "the gear turns a body that is not dynamic",
                          "a \"bodyB\" of type 2 in both joints");
            return;
        }
    }
    if (one.bodyB == two.bodyB)
        context.error(place.node, place.pointer, "the gear joins a body to itself",
                      "two joints with different \"bodyB\"");
}

JointDefinition readJoint(Context& context, const ArrayItem& place, std::size_t bodies, std::size_t joints) {
    ObjectReader reader(context, place.node, place.pointer, true);
    JointDefinition j;
    j.name = reader.string("name", "");
    reader.require("type", "a kind of joint");
    const std::size_t type = reader.choice("type", kJointKinds, kJointKinds.size());
    if (type == kJointKinds.size()) // the other keys depend on it
        return j;
    const std::string& kind = kJointKinds[type];
    const bool rope = kind == "rope";
    const auto index =
        std::find(kJointKinds.begin(), kJointKinds.end(), rope ? "distance" : kind) - kJointKinds.begin();
    j.kind = static_cast<JointKind>(index);
    readBodies(context, reader, bodies, j);
    readPlace(context, reader, j);
    j.collideConnected = reader.boolean("collideConnected", false);
    readMotor(reader, j);
    j.frequency = reader.number("frequency", reader.number("springFrequency", 0.0, notNegative), notNegative);
    j.dampingRatio = reader.number("dampingRatio", reader.number("springDampingRatio", 0.0, notNegative), notNegative);
    j.correctionFactor = reader.number("correctionFactor", j.correctionFactor, {0.0, 1.0});
    readMechanics(context, reader, j);
    if (rope)
        readRope(reader, j);
    else if (j.kind == JointKind::Pulley)
        readPulley(context, reader, j);
    else if (j.kind == JointKind::Gear)
        readGear(context, reader, joints, j);
    else if (j.kind == JointKind::Mouse)
        readMouse(context, reader, j);
    reader.ignore({"jointSpeed", "linearOffset", "customProperties", "maxTorque", "path"});
    reader.finish();
    if (j.enableLimit && j.lowerLimit > j.upperLimit)
        context.error(place.node, place.pointer, "the joint's limits are empty", "lowerLimit <= upperLimit");
    return j;
}

} // namespace

void readJoints(Context& context, ObjectReader& top, RigidWorldDefinition& out) {
    const std::size_t before = context.errors();
    const auto places = top.array("joint");
    const std::size_t count = places.size();
    for (const ArrayItem& place : places)
        out.joints.push_back(readJoint(context, place, out.bodies.size(), count));
    if (context.errors() != before)
        return;
    auto joint = out.joints.begin();
    for (const ArrayItem& place : places) {
        if (joint->kind == JointKind::Gear)
            checkGear(context, place, out, *joint);
        ++joint;
    }
}

} // namespace supercircle::scene
