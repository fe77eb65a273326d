#include "bridge/box2d/rigid_check.h"

#include "supercircle/support/elementary.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <cmath>
#include <initializer_list>
#include <sstream>
#include <utility>
#include <vector>

namespace supercircle::bridge {

namespace {

using rod::cross;
using step::BodyDefinition;
using step::FixtureDefinition;
using step::JointDefinition;
using step::JointKind;
using step::RigidWorldDefinition;
using step::ShapeKind;
using step::Vec2;

// In host units. A float at 1e4 resolves 1 mm of the host, a fifth of Box2D's slop.
constexpr double kMaxLength = 1e4;
constexpr double kMaxRate = 1e6;
constexpr double kMinArea = 1e-6; // Box2D asserts on 1.2e-7
constexpr double kMaxMass = 1e20;
constexpr double kMinMass = 1e-20;   // its inverse must be a float as well
constexpr double kMinInertia = 1e-4; // of the part about the origin: Box2D subtracts the rest in single precision

/// Of shapes that are too small for Box2D's tolerances.
const std::string kRemedy = "raise the length scale: lengthScale of a scene, units_per_metre of a world";

bool bounded(double v, double limit) {
    return std::abs(v) <= limit;
} // false for NaN
bool bounded(const Vec2& v, double limit) {
    return bounded(v.x(), limit) && bounded(v.y(), limit);
}

double signedArea(const std::vector<Vec2>& v) {
    double area = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i)
        area += 0.5 * cross(v[i] - v[0], v[(i + 1) % v.size()] - v[0]);
    return area;
}

std::string number(double v) {
    std::ostringstream text;
    text << v;
    return text.str();
}

std::string checkPolygon(const std::vector<Vec2>& v, double scale) {
    if (v.size() < 3 || v.size() > b2_maxPolygonVertices)
        return "a polygon has 3 to 8 vertices, this one " + std::to_string(v.size());
    const double sign = signedArea(v) < 0.0 ? -1.0 : 1.0;
    double turned = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec2 in = v[i] - v[(i + v.size() - 1) % v.size()];
        const Vec2 out = v[(i + 1) % v.size()] - v[i];
        if (sign * cross(in, out) < -1e-9 * in.norm() * out.norm())
            return "the polygon is not convex at vertex " + std::to_string(i);
        turned += math::atan2(sign * cross(in, out), in.dot(out));
        for (std::size_t j = 0; j < i; ++j) {
            if ((v[i] - v[j]).norm() * scale < b2_linearSlop)
                return "vertices " + std::to_string(j) + " and " + std::to_string(i) +
                       " are closer than Box2D's tolerance of " + number(b2_linearSlop / scale) + " m (" + kRemedy +
                       ")";
        }
    }
    if (std::abs(turned - 2.0 * M_PI) > 0.1)
        return "the polygon winds around more than once";
    if (sign * signedArea(v) * scale * scale < kMinArea)
        return "the polygon's area is below Box2D's limit of " + number(kMinArea / (scale * scale)) + " m^2 (" +
               kRemedy + ")";
    return {};
}

std::string checkChain(const FixtureDefinition& f, double scale) {
    const bool loop = f.shape == ShapeKind::Loop;
    std::vector<Vec2> v = f.vertices;
    if (loop && v.size() > 1 && (v.front() - v.back()).isZero(0.0))
        v.pop_back();
    if (v.size() < (loop ? 3U : 2U))
        return loop ? "a loop has at least 3 vertices" : "a chain has at least 2 vertices";
    for (std::size_t i = loop ? 0 : 1; i < v.size(); ++i) {
        const Vec2 edge = v[i] - v[(i + v.size() - 1) % v.size()];
        if (edge.norm() * scale < 1.01 * b2_linearSlop)
            return "the edge that ends at vertex " + std::to_string(i) + " is shorter than Box2D's tolerance of " +
                   number(b2_linearSlop / scale) + " m (" + kRemedy + ")";
    }
    return {};
}

std::string checkFixture(const FixtureDefinition& f, double scale) {
    for (const Vec2& v : f.vertices) {
        if (!bounded(v, kMaxLength / scale))
            return "a vertex is not finite or farther out than " + number(kMaxLength / scale) + " m";
    }
    if (!bounded(f.density, 1e12) || f.density < 0.0)
        return "density must be finite and not negative";
    if (!bounded(f.friction, 1e6) || f.friction < 0.0)
        return "friction must be finite and not negative";
    if (!bounded(f.restitution, 1e6) || f.restitution < 0.0)
        return "restitution must be finite and not negative";
    switch (f.shape) {
    case ShapeKind::Circle:
        if (!bounded(f.centre, kMaxLength / scale))
            return "the circle's centre is not finite or farther out than " + number(kMaxLength / scale) + " m";
        if (!bounded(f.radius, kMaxLength / scale) || f.radius * scale < 1e-3)
            return "the circle's radius must lie between " + number(1e-3 / scale) + " and " +
                   number(kMaxLength / scale) + " m (for smaller ones " + kRemedy + ")";
        return {};
    case ShapeKind::Polygon:
        return checkPolygon(f.vertices, scale);
    case ShapeKind::Chain:
    case ShapeKind::Loop:
        return checkChain(f, scale);
    }
    return "unknown shape";
}

/// Area, first and second moments about the body origin, SI.
struct Moments {
    double mass = 0.0;
    Vec2 first = Vec2::Zero();
    double second = 0.0;
};

void addMoments(const FixtureDefinition& f, Moments& m) {
    if (f.shape == ShapeKind::Circle) {
        const double mass = f.density * M_PI * f.radius * f.radius;
        m.mass += mass;
        m.first += mass * f.centre;
        m.second += mass * (0.5 * f.radius * f.radius + f.centre.squaredNorm());
    } else if (f.shape == ShapeKind::Polygon) {
        const double sign = signedArea(f.vertices) < 0.0 ? -1.0 : 1.0;
        for (std::size_t i = 0; i < f.vertices.size(); ++i) { // triangles with the origin
            const Vec2& a = f.vertices[i];
            const Vec2& b = f.vertices[(i + 1) % f.vertices.size()];
            const double mass = sign * f.density * 0.5 * cross(a, b);
            m.mass += mass;
            m.first += mass * (a + b) / 3.0;
            m.second += mass * (a.squaredNorm() + a.dot(b) + b.squaredNorm()) / 6.0;
        }
    }
}

std::string checkMassData(const BodyDefinition& b, double scale) {
    const step::MassData& d = *b.massData;
    if (!bounded(d.mass, kMaxMass) || d.mass < 0.0 || !bounded(d.centre, kMaxLength / scale) ||
        !bounded(d.inertia, kMaxMass / (scale * scale)) || d.inertia < 0.0)
        return "mass data must be finite and not negative";
    if (d.mass <= 0.0)
        return {};
    if (d.mass < kMinMass)
        return "the mass is too small for single precision";
    const double central = d.inertia - d.mass * d.centre.squaredNorm();
    if (d.inertia > 0.0 && !b.fixedRotation && central < kMinInertia * d.inertia)
        return "the inertia is about the body origin and must exceed mass times the squared distance of the centre";
    return {};
}

std::string checkBody(const BodyDefinition& b, double scale) {
    if (!bounded(b.position, kMaxLength / scale))
        return "the position is not finite or farther out than " + number(kMaxLength / scale) +
               " m (Box2D computes in single precision)";
    if (!bounded(b.linearVelocity, kMaxRate / scale))
        return "linearVelocity is not finite or faster than " + number(kMaxRate / scale) + " m/s";
    if (!bounded(b.angle, kMaxLength) || !bounded(b.angularVelocity, kMaxRate) || !bounded(b.gravityScale, kMaxRate))
        return "angle, angularVelocity or gravityScale is not finite or too large";
    if (!bounded(b.linearDamping, kMaxRate) || b.linearDamping < 0.0 || !bounded(b.angularDamping, kMaxRate) ||
        b.angularDamping < 0.0)
        return "damping must be finite and not negative";
    if (b.massData) {
        std::string why = checkMassData(b, scale);
        if (!why.empty())
            return why;
    }
    Moments m;
    for (std::size_t i = 0; i < b.fixtures.size(); ++i) {
        const FixtureDefinition& f = b.fixtures[i];
        std::string why = checkFixture(f, scale);
        addMoments(f, m);
        if (why.empty() && m.mass > 0.0 && b.type == step::BodyType::Dynamic) {
            const double central = m.second - m.first.squaredNorm() / m.mass;
            if (!(m.mass < kMaxMass) || !(m.second * scale * scale < kMaxMass))
                why = "the mass or inertia is too large for single precision";
            else if (m.mass < kMinMass || m.second * scale * scale < kMinMass)
                why = "the mass or inertia is too small for single precision";
            else if (!b.fixedRotation && central < kMinInertia * m.second)
                why = "the body's mass lies too far from its origin for single precision; move the origin nearer";
        }
        if (!why.empty())
            return "fixture " + std::to_string(i) + (f.name.empty() ? "" : " '" + f.name + "'") + ": " + why;
    }
    return {};
}

std::string checkJoint(const JointDefinition& j, std::size_t bodies, double scale) {
    const auto inRange = [&](std::int32_t i) { return i >= 0 && static_cast<std::size_t>(i) < bodies; };
    for (const std::int32_t body : {j.bodyA, j.bodyB}) {
        if (!inRange(body))
            return "body index " + std::to_string(body) + " is out of range (there are " + std::to_string(bodies) +
                   " bodies)";
    }
    if (j.bodyA == j.bodyB)
        return "both ends are on body " + std::to_string(j.bodyA);
    if (!bounded(j.anchorA, kMaxLength / scale) || !bounded(j.anchorB, kMaxLength / scale))
        return "an anchor is not finite or farther out than " + number(kMaxLength / scale) + " m";
    for (const Vec2& point : {j.groundAnchorA, j.groundAnchorB, j.target})
        if (!bounded(point, kMaxLength / scale))
            return "groundAnchorA, groundAnchorB or target is not finite or farther out than " +
                   number(kMaxLength / scale) + " m";
    const std::initializer_list<std::pair<const char*, double>> plain = {{"refAngle", j.refAngle},
                                                                         {"lowerLimit", j.lowerLimit},
                                                                         {"upperLimit", j.upperLimit},
                                                                         {"motorSpeed", j.motorSpeed},
                                                                         {"maxMotorForce", j.maxMotorForce},
                                                                         {"maxTorque", j.maxTorque},
                                                                         {"frequency", j.frequency},
                                                                         {"dampingRatio", j.dampingRatio},
                                                                         {"length", j.length},
                                                                         {"lengthA", j.lengthA},
                                                                         {"lengthB", j.lengthB},
                                                                         {"ratio", j.ratio}};
    for (const auto& [name, value] : plain) {
        if (!bounded(value, 1e12))
            return std::string(name) + " is not finite or too large";
    }
    if (j.spring.on() || j.friction.sticking > 0.0)
        return "Box2D has no springs or dry friction in joints; `supercircle replay` plays an experiment with this "
               "scene";
    if (j.enableLimit && j.lowerLimit > j.upperLimit)
        return "lowerLimit is above upperLimit";
    if (j.maxMotorForce < 0.0 || j.maxTorque < 0.0 || j.frequency < 0.0 || j.dampingRatio < 0.0)
        return "maxMotorForce, maxTorque, frequency and dampingRatio must not be negative";
    const bool needsAxis = j.kind == JointKind::Prismatic || j.kind == JointKind::Wheel;
    if (needsAxis && (!bounded(j.localAxisA, 1e6) || j.localAxisA.norm() < 1e-6))
        return "localAxisA must be a direction";
    if (j.kind == JointKind::Distance && (j.length < 0.0 || (j.enableLimit && j.lowerLimit < 0.0)))
        return "lengths must not be negative";
    if (!(j.correctionFactor >= 0.0 && j.correctionFactor <= 1.0))
        return "correctionFactor must lie between 0 and 1";
    if (j.kind == JointKind::Pulley && !(j.ratio > 0.0 && j.lengthA >= 0.0 && j.lengthB >= 0.0))
        return "the ratio of a pulley must be above 0, its lengths not negative";
    if (j.kind == JointKind::Mouse && !(j.frequency > 0.0))
        return "a mouse joint needs a frequency above 0";
    return {};
}

/// Box2D asserts that a gear joins two revolute or prismatic joints with different dynamic bodies B.
std::string checkGear(const JointDefinition& j, const RigidWorldDefinition& d) {
    std::int32_t driven = -1;
    for (const std::int32_t index : {j.joint1, j.joint2}) {
        if (index < 0 || static_cast<std::size_t>(index) >= d.joints.size())
            return "joint index " + std::to_string(index) + " is out of range";
        const JointDefinition& part = d.joints[static_cast<std::size_t>(index)];
        if (part.kind != JointKind::Revolute && part.kind != JointKind::Prismatic)
            return "a gear joins revolute and prismatic joints only";
        if (d.bodies[static_cast<std::size_t>(part.bodyB)].type != step::BodyType::Dynamic || part.bodyB == driven)
            return "the bodies B of a gear's joints must be two dynamic bodies";
        driven = part.bodyB;
    }
    return {};
}

std::string called(const char* what, std::size_t index, const std::string& name) {
    return std::string(what) + " " + std::to_string(index) + (name.empty() ? "" : " '" + name + "'") + ": ";
}

} // namespace

std::string checkDefinition(const RigidWorldDefinition& d) {
    if (!std::isfinite(d.lengthScale) || d.lengthScale < 1e-3 || d.lengthScale > 1e6)
        return "lengthScale must lie between 1e-3 and 1e6 units per metre";
    if (!bounded(d.gravity, kMaxRate / d.lengthScale))
        return "gravity is not finite or too large";
    for (std::size_t i = 0; i < d.bodies.size(); ++i) {
        const std::string why = checkBody(d.bodies[i], d.lengthScale);
        if (!why.empty())
            return called("body", i, d.bodies[i].name) + why;
    }
    for (std::size_t i = 0; i < d.joints.size(); ++i) {
        const std::string why = checkJoint(d.joints[i], d.bodies.size(), d.lengthScale);
        if (!why.empty())
            return called("joint", i, d.joints[i].name) + why;
    }
    for (std::size_t i = 0; i < d.joints.size(); ++i) {
        const std::string why = d.joints[i].kind == JointKind::Gear ? checkGear(d.joints[i], d) : std::string();
        if (!why.empty())
            return called("joint", i, d.joints[i].name) + why;
    }
    return {};
}

} // namespace supercircle::bridge
