// Joints of a mechanism: what they lock, the motion they leave free, springs and dry friction along it.

#include "plugin/identification/replay/multibody.h"
#include "plugin/identification/replay/plane.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supercircle::replay {

using Eigen::Index;
using Eigen::VectorXd;
using step::JointKind;

namespace {

/// What of a joint mechanisms do not simulate, and what to do instead; empty: nothing.
std::string notTaken(const step::JointDefinition& d) {
    if (d.kind != JointKind::Revolute && d.kind != JointKind::Weld && d.kind != JointKind::Prismatic &&
        d.kind != JointKind::Distance)
        return "mechanisms have no joints of this type; expected \"revolute\", \"prismatic\", \"distance\" or \"weld\"";
    if (d.kind == JointKind::Weld && d.frequency > 0.0)
        return "a \"frequency\" makes the weld a spring of Box2D, which mechanisms do not simulate; expected a "
               "revolute "
               "joint with \"spring\": {\"stiffness_N_m_rad\": ...}";
    if (d.kind != JointKind::Revolute && d.frequency > 0.0)
        return "\"frequency\" states a spring of Box2D, which mechanisms do not simulate; expected \"spring\": "
               "{\"stiffness_N_m\": ...}";
    if (d.enableLimit)
        return "mechanisms have no limits of joints and no ropes; expected one without \"enableLimit\", in runs that "
               "stay within the limits";
    if (d.enableMotor && d.maxMotorForce > 0.0)
        return "mechanisms have no motors of joints; expected one without \"enableMotor\", and a \"protocol\" whose "
               "machine moves a body";
    return {};
}

} // namespace

void Multibody::addJoint(const step::JointDefinition& d) {
    const auto count = static_cast<std::int32_t>(bodies_.size());
    if (d.bodyA < 0 || d.bodyB < 0 || d.bodyA >= count || d.bodyB >= count)
        return;
    if (const std::string why = notTaken(d); !why.empty()) {
        failure_ = "joint \"" + d.name + "\": " + why;
        return;
    }
    Joint j;
    j.kind = d.kind;
    j.a = d.bodyA;
    j.b = d.bodyB;
    j.onA = d.anchorA - bodies_[static_cast<std::size_t>(d.bodyA)].centre;
    j.onB = d.anchorB - bodies_[static_cast<std::size_t>(d.bodyB)].centre;
    j.axis = d.localAxisA;
    j.refAngle = d.refAngle;
    j.length = d.length;
    j.spring = d.spring;
    j.springs = d.kind == JointKind::Distance && d.spring.on();
    j.sliding = d.friction.sliding;
    j.sticking = d.friction.sticking;
    j.site.age = friction_.stateRest;
    joints_.push_back(j);
}

bool Multibody::hasDryFriction(const Joint& j) const {
    const bool bearing = j.kind == JointKind::Revolute && (extra_.bearingTorque > 0.0 || extra_.bearingArm > 0.0);
    const bool guide = j.kind == JointKind::Prismatic && extra_.guideForce > 0.0 && !j.own();
    return j.free() && (bearing || guide || j.sliding > 0.0 || j.sticking > 0.0);
}

bool Multibody::anyDryFriction() const {
    return std::any_of(joints_.begin(), joints_.end(), [&](const Joint& j) { return hasDryFriction(j); });
}

std::size_t Multibody::rowsOf(const Joint& j) const {
    switch (j.kind) {
    case JointKind::Weld:
        return 3;
    case JointKind::Distance:
        return j.springs ? 0 : 1;
    default:
        return 2;
    }
}

/// Rate at which B moves off A along `inA`, a unit vector that turns with A.
Multibody::Row Multibody::along(const Joint& j, const Vec2& inA, const VectorXd& y) const {
    const Motion a = motionOf(j.a, y), b = motionOf(j.b, y);
    const Vec2 e = rotated(inA, a.angle), side(-e.y(), e.x());
    const Vec2 onB = rotated(j.onB, b.angle), arm = b.position + onB - a.position;
    const Vec2 armRate = b.velocity + crossSpin(b.spin, onB) - a.velocity;
    Row row;
    row.a << -e, -cross(arm, e);
    row.b << e, cross(onB, e);
    row.bias = a.spin * side.dot(b.velocity - a.velocity) - a.spin * (cross(armRate, e) + a.spin * cross(arm, side)) +
               b.spin * (cross(crossSpin(b.spin, onB), e) + a.spin * cross(onB, side));
    return row;
}

Multibody::Row Multibody::turn() const {
    Row row;
    row.a.z() = -1.0;
    row.b.z() = 1.0;
    return row;
}

Multibody::Coordinate Multibody::coordinate(const Joint& j, const VectorXd& y) const {
    const Motion a = motionOf(j.a, y), b = motionOf(j.b, y);
    Coordinate c;
    if (j.kind == JointKind::Revolute || j.kind == JointKind::Weld) {
        c.row = turn();
        c.value = b.angle - a.angle - j.refAngle;
        c.rate = b.spin - a.spin;
        return c;
    }
    const Vec2 onA = rotated(j.onA, a.angle), onB = rotated(j.onB, b.angle);
    const Vec2 way = b.position + onB - a.position - onA;
    if (j.kind == JointKind::Prismatic) {
        c.row = along(j, j.axis, y);
        c.value = way.dot(rotated(j.axis, a.angle));
    } else { // along the line between the anchors, which turns by itself
        c.value = way.norm();
        const Vec2 e = c.value > 0.0 ? Vec2(way / c.value) : Vec2(Vec2::UnitX());
        c.row.a << -e, -cross(onA, e);
        c.row.b << e, cross(onB, e);
        const Vec2 rate = b.velocity + crossSpin(b.spin, onB) - a.velocity - crossSpin(a.spin, onA);
        const Vec2 across = rate - rate.dot(e) * e;
        c.row.bias = e.dot(a.spin * a.spin * onA - b.spin * b.spin * onB) +
                     (c.value > 0.0 ? across.squaredNorm() / c.value : 0.0);
    }
    const auto rate = [](const Eigen::Vector3d& row, const Motion& m) {
        return row.x() * m.velocity.x() + row.y() * m.velocity.y() + row.z() * m.spin;
    };
    c.rate = rate(c.row.a, a) + rate(c.row.b, b);
    return c;
}

double Multibody::relativeRate(const Joint& j, const VectorXd& y) const {
    return j.kind == JointKind::Revolute ? motionOf(j.b, y).spin - motionOf(j.a, y).spin : coordinate(j, y).rate;
}

/// How far the locked motions are off, in the order of the rows.
VectorXd Multibody::gapsOf(const Joint& j, const VectorXd& y) const {
    const Motion a = motionOf(j.a, y), b = motionOf(j.b, y);
    const Vec2 way = b.position + rotated(j.onB, b.angle) - a.position - rotated(j.onA, a.angle);
    VectorXd gaps(static_cast<Index>(rowsOf(j)));
    if (j.kind == JointKind::Distance) {
        if (!j.springs)
            gaps[0] = way.norm() - j.length;
        return gaps;
    }
    if (j.kind == JointKind::Prismatic)
        gaps[0] = way.dot(rotated(Vec2(-j.axis.y(), j.axis.x()), a.angle));
    else
        gaps.head<2>() = way;
    if (j.kind != JointKind::Revolute)
        gaps[gaps.size() - 1] = b.angle - a.angle - j.refAngle;
    return gaps;
}

void Multibody::write(const Joint& j, const Row& row, Index at, const VectorXd& y, Rows& rows) const {
    for (const auto& [body, part] : {std::pair{j.a, &row.a}, std::pair{j.b, &row.b}}) {
        const Body& b = bodies_[static_cast<std::size_t>(body)];
        if (b.moving >= 0) {
            rows.J.row(at).segment<3>(3 * b.moving) += part->transpose();
            continue;
        }
        const Motion m = motionOf(b, y);
        rows.given[at] += part->x() * m.velocity.x() + part->y() * m.velocity.y() + part->z() * m.spin;
        if (body == driven_)
            rows.driven.row(at) += part->transpose();
    }
    rows.bias[at] = row.bias;
}

/// Rows of all joints, with one more for each that sticks if `withResting`.
Multibody::Rows Multibody::rowsAt(const VectorXd& y, bool withResting) const {
    const auto rests = [&](const Joint& j) { return withResting && j.turning == 0 && hasDryFriction(j); };
    Index count = 0;
    for (const Joint& j : joints_)
        count += static_cast<Index>(rowsOf(j)) + (rests(j) ? 1 : 0);
    Rows rows;
    rows.J.setZero(count, 3 * moving_);
    rows.driven.setZero(count, 3);
    rows.bias.setZero(count);
    rows.given.setZero(count);
    Index at = 0;
    for (const Joint& j : joints_) {
        if (j.kind == JointKind::Prismatic)
            write(j, along(j, Vec2(-j.axis.y(), j.axis.x()), y), at++, y, rows);
        else if (j.kind == JointKind::Distance && !j.springs)
            write(j, coordinate(j, y).row, at++, y, rows);
        if (j.kind == JointKind::Revolute || j.kind == JointKind::Weld) {
            const Motion a = motionOf(j.a, y), b = motionOf(j.b, y);
            const Vec2 onA = rotated(j.onA, a.angle), onB = rotated(j.onB, b.angle);
            for (const Vec2& e : {Vec2(Vec2::UnitX()), Vec2(Vec2::UnitY())}) {
                Row row;
                row.a << -e, -cross(onA, e);
                row.b << e, cross(onB, e);
                row.bias = e.dot(a.spin * a.spin * onA - b.spin * b.spin * onB);
                write(j, row, at++, y, rows);
            }
        }
        if (j.kind == JointKind::Weld || j.kind == JointKind::Prismatic)
            write(j, turn(), at++, y, rows);
        if (rests(j))
            write(j, coordinate(j, y).row, at++, y, rows);
    }
    return rows;
}

/// Cubic part of a spring over the linear one, 1/m^2 or 1/rad^2.
double Multibody::cubicOf(const Joint& j) const {
    return j.spring.cubic + (j.kind == JointKind::Revolute ? extra_.turningSpringCubic : extra_.springCubic);
}

/// Force of a damper over the rate of its coordinate.
double Multibody::viscosityOf(const Joint& j, double rate) const {
    if (j.kind == JointKind::Revolute)
        return j.spring.viscosity + extra_.bearingViscosity;
    if (j.kind != JointKind::Prismatic || j.own())
        return j.spring.viscosity;
    return j.spring.viscosity + extra_.guideViscosity + extra_.guideQuadratic * std::abs(rate);
}

/// A force along a row, on B and against A.
void Multibody::apply(const Joint& j, const Row& row, double force, VectorXd& on, Eigen::Vector3d& driven) const {
    for (const auto& [body, part] : {std::pair{j.a, &row.a}, std::pair{j.b, &row.b}}) {
        if (const int m = bodies_[static_cast<std::size_t>(body)].moving; m >= 0)
            on.segment<3>(3 * m) += force * *part;
        else if (body == driven_)
            driven += force * *part;
    }
}

/// Dry friction of a joint, `since` s after the start of a step: of sliding at `rate`, or the largest at rest.
double Multibody::dryFriction(const Joint& j, double reaction, double rate, double since) const {
    const double bearing = j.kind == JointKind::Revolute ? extra_.bearingTorque + extra_.bearingArm * reaction
                           : j.own()                     ? 0.0
                                                         : extra_.guideForce;
    const double own = j.turning == 0 ? j.sticking : j.sliding;
    if (own <= 0.0)
        return bearing;
    if (j.turning != 0 && j.held >= 0.0)
        return bearing + own * j.held;
    const double speed = j.turning == 0 ? 0.0 : std::max(0.0, j.turning * rate);
    return bearing + own * (friction_.on() ? effects::frictionFactor(friction_, j.site, speed, since) : 1.0);
}

} // namespace supercircle::replay
