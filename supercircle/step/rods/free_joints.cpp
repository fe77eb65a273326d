// The joints of a group that moves freely: where their ends are, and what they do in a stage.

#include "supercircle/step/applied_forces.h"
#include "supercircle/step/rods/free_system.h"
#include "supercircle/support/trig.h"

#include <cmath>

namespace supercircle::step {

namespace {

Vec2 turned(const Vec2& v, double angle) {
    const double c = math::cos(angle), s = math::sin(angle);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

} // namespace

FreeSystem::Places FreeSystem::placesOf(const FreeJoint& j, double ahead, At at) {
    const Link& l = linkOf(j);
    Places p;
    const auto ia = static_cast<std::size_t>(j.a);
    const rod::MaterialPoint atA = rod::locate(rod(ia).model, l.sA);
    p.a = work(ia).kin.point(atA) + free(ia).middle;
    p.angleA = work(ia).kin.angle(atA);
    if (j.b >= 0) {
        const auto ib = static_cast<std::size_t>(j.b);
        const rod::MaterialPoint atB = rod::locate(rod(ib).model, l.sB);
        p.angleB = work(ib).kin.angle(atB);
        p.offset = turned(l.local, p.angleB);
        p.b = work(ib).kin.point(atB) + free(ib).middle + p.offset;
    } else if (j.freeBody >= 0) {
        const FreeBody& b = g_.bodies[static_cast<std::size_t>(j.freeBody)];
        const Eigen::Vector3d& q = at == At::State ? b.q : b.stages[at == At::First ? 0 : 1].q;
        p.angleB = q.z();
        p.offset = turned(l.local, p.angleB);
        p.b = q.head<2>() + p.offset;
        p.spin = b.drift.z();
        p.velocity = b.drift.head<2>() + p.spin * rod::perp(p.offset);
    } else if (j.body >= 0) {
        const BodyState& s = world_.bodies[static_cast<std::size_t>(j.body)].state;
        const BodyMotion& m = motion_[static_cast<std::size_t>(j.body)];
        p.angleB = s.angle + ahead * m.spin;
        p.offset = turned(l.local, p.angleB);
        p.b = s.centre + ahead * m.velocity + p.offset;
        p.spin = m.spin;
        p.velocity = m.velocity + p.spin * rod::perp(p.offset);
    } else {
        const Pose goal = poseAfter(world_, l.target, ahead);
        p.b = goal.point;
        p.velocity = goal.velocity;
    }
    return p;
}

/// What the rows of a joint are to add to their ends.
Eigen::Vector3d FreeSystem::gapOf(const FreeJoint& j, const Places& p) const {
    const Link& l = linkOf(j);
    if (l.kind == LinkKind::Tether)
        return {(p.b - p.a).norm() - l.length, 0.0, 0.0};
    const Vec2 apart = p.b - p.a;
    return {apart.x(), apart.y(), l.kind == LinkKind::Weld ? p.angleB + l.angle - p.angleA : 0.0};
}

Eigen::Vector3d FreeSystem::givenRate(const FreeJoint& j, const Places& p) const {
    if (linkOf(j).kind == LinkKind::Tether)
        return {p.velocity.dot((p.b - p.a).normalized()), 0.0, 0.0};
    return {p.velocity.x(), p.velocity.y(), p.spin};
}

/// A gap that was found is closed by the ordinary step, with a bounded speed. What free motion leaves is far less.
bool FreeSystem::isClosed(const FreeJoint& j) {
    constexpr double kClosed = 1e-7; // of the length
    const Eigen::Vector3d gap = gapOf(j, placesOf(j, 0.0, At::State));
    const double length = rod(static_cast<std::size_t>(j.a)).model.definition().length;
    return gap.head<2>().norm() < kClosed * length && std::abs(gap.z()) < kClosed;
}

/// What the joints do in a stage that was solved. False: a tether does not do what it did at the start of the step.
bool FreeSystem::record(std::size_t stage, double ahead) {
    for (FreeJoint& j : g_.joints) {
        const Places p = placesOf(j, ahead, stage == 0 ? At::First : At::Second);
        const bool tether = linkOf(j).kind == LinkKind::Tether;
        if (j.rows == 0) {
            if (gapOf(j, p).x() > 0.0)
                return false;
            continue;
        }
        FreeJointStage& s = j.stages[stage];
        const Eigen::VectorXd& impulses = free(static_cast<std::size_t>(j.a)).stages[stage].impulse;
        const auto own = impulses.segment(j.atA, j.rows);
        if (tether && !(own[0] > 0.0))
            return false;
        const Vec2 force = tether ? Vec2(own[0] * (p.b - p.a).normalized()) : Vec2(own[0], own[1]);
        const double torque = j.rows == 3 ? own[2] : 0.0;
        s.impulse = {force.x(), force.y(), torque};
        s.given = own.dot(givenRate(j, p).head(j.rows));
        if (j.freeBody >= 0) {
            const Eigen::Vector3d& v = g_.bodies[static_cast<std::size_t>(j.freeBody)].stages[stage].v;
            s.turn = rod::cross(p.offset, force) + torque;
            s.toBody = -(force.dot(v.head<2>()) + s.turn * v.z());
        }
    }
    return true;
}

} // namespace supercircle::step
