#include "supercircle/step/applied_forces.h"

#include "supercircle/support/invariants.h"

#include <algorithm>
#include <cmath>

namespace supercircle::step {

namespace {

constexpr double kSameTime = 1e-9; ///< of a path's duration: round-off of World::time

/// Cubic from the pose and velocity at its start to those at its end (Hermite), straight on afterwards.
Pose along(const Path& p, double time) {
    const double T = p.end - p.start, left = time - p.end;
    SC_ASSERT(!(T < 0.0), "a path ends after its start");
    if (left >= -kSameTime * T) {
        const double over = left > kSameTime * T ? left : 0.0; // at its end: to the last digit
        return {p.to + over * p.toVelocity, p.toAngle + over * p.toSpin, p.toVelocity, p.toSpin};
    }
    const double x = (time - p.start) / T, y = 1.0 - x;
    const double a = y * y * (1.0 + 2.0 * x), b = x * y * y * T, c = x * x * (3.0 - 2.0 * x), d = -x * x * y * T;
    const double da = -6.0 * x * y / T, db = y * (y - 2.0 * x), dc = -da, dd = x * (x - 2.0 * y);
    return {a * p.from + b * p.fromVelocity + c * p.to + d * p.toVelocity,
            a * p.fromAngle + b * p.fromSpin + c * p.toAngle + d * p.toSpin,
            da * p.from + db * p.fromVelocity + dc * p.to + dd * p.toVelocity,
            da * p.fromAngle + db * p.fromSpin + dc * p.toAngle + dd * p.toSpin};
}

void start(const World& world, double time, const Pose& now, Path& path) {
    path.active = true;
    path.start = world.time;
    path.end = world.time + time;
    path.from = now.point;
    path.fromVelocity = now.velocity;
    path.fromAngle = now.angle;
    path.fromSpin = now.spin;
}

bool over(const World& world, const Path& p, double dt) {
    return world.time + dt >= p.end - kSameTime * (p.end - p.start);
}

void rowsAt(const Rod& rod, const RodWork& w, double s, Eigen::Matrix<double, 2, Eigen::Dynamic>& rows) {
    rows.resize(2, rod.model.dofs());
    w.kin.pointRows(rod.model, rod::locate(rod.model, s), Vec2::Zero(), Vec2::UnitX(), Vec2::UnitY(), rows);
}

double shareOf(const MouseJoint& g, const Vec2& force) {
    const double size = force.norm();
    return size > g.maxForce ? g.maxForce / size : 1.0;
}

/// Force of a mouse joint as its work space says, for the velocity `v`.
Vec2 forceOf(const MouseJointWork& g, double dt, const Eigen::VectorXd& v) {
    const Vec2 u = g.J * v;
    return g.stiffness * (g.stretch - dt * u) - g.damping * u;
}

} // namespace

Pose poseAfter(const World& world, const Hold& h, double ahead) {
    const Target& t = h.target;
    if (const double last = h.stop.time - world.time; last < ahead) {
        const Pose end = poseAfter(world, t, std::max(last, 0.0));
        return {end.point, end.angle, Vec2::Zero(), 0.0};
    }
    if (t.path.active || !h.onCrosshead)
        return poseAfter(world, t, ahead);
    return {t.point + ahead * world.crossheadVelocity, t.angle + ahead * t.spin, world.crossheadVelocity, t.spin};
}

Pose poseAfter(const World& world, const Target& t, double ahead) {
    if (t.path.active)
        return along(t.path, world.time + ahead);
    return {t.point + ahead * t.velocity, t.angle + ahead * t.spin, t.velocity, t.spin};
}

void advanceTarget(const World& world, double dt, Hold& h) {
    const Pose p = poseAfter(world, h, dt);
    if (h.stop.time < world.time + dt) {
        h.target.velocity.setZero();
        h.target.spin = 0.0;
        h.target.path.active = false;
    } else if (h.target.path.active || !h.onCrosshead) {
        return advanceTarget(world, dt, h.target);
    }
    h.target.point = p.point;
    h.target.angle = p.angle;
}

void advanceTarget(const World& world, double dt, Target& t) {
    const Pose p = poseAfter(world, t, dt);
    t.point = p.point;
    t.angle = p.angle;
    t.velocity = p.velocity;
    t.spin = p.spin;
    t.path.active = t.path.active && !over(world, t.path, dt);
}

void startPaths(World& world, double time) {
    const auto go = [&](const Pose& now, Target& target) {
        if (!target.pending)
            return;
        start(world, time, now, target.path);
        target.pending = false;
    };
    for (Rod& r : world.rods)
        for (Hold& h : r.holds)
            go(poseAfter(world, h, 0.0), h.target);
    for (Link& l : world.links)
        go(poseAfter(world, l.target, 0.0), l.target);
}

double wayOfHolds(const Rod& rod, double frame) {
    double way = 0.0;
    for (const Hold& h : rod.holds) {
        const Target& t = h.target;
        const Path& p = t.path;
        if (h.onCrosshead)
            continue;
        if (p.active || t.pending) { // the two velocities of a cubic carry it by no more than 4/27 of its time
            const Vec2 from = t.pending ? t.point : p.from, start = t.pending ? t.velocity : p.fromVelocity;
            const double time = std::max(frame, t.pending ? 0.0 : p.end - p.start);
            way = std::max(way, (p.to - from).norm() + time * 4.0 / 27.0 * (start.norm() + p.toVelocity.norm()));
        }
        if (!t.pending)
            way = std::max(way, frame * (p.active ? p.toVelocity : t.velocity).norm());
    }
    return way;
}

void endOfFrame(World& world) {
    for (Rod& r : world.rods)
        std::erase_if(r.forces, [](const AppliedForce& f) { return f.once; });
}

void addLoads(const Rod& rod, double dt, bool first, RodWork& w) {
    w.load.resize(0);
    if (!rod.forces.empty()) {
        w.load.setZero(rod.model.dofs());
        Eigen::RowVectorXd turn(rod.model.dofs());
        for (const AppliedForce& f : rod.forces) {
            rowsAt(rod, w, f.s, w.rowsOfLoad);
            w.load += w.rowsOfLoad.transpose() * f.force;
            if (f.torque != 0.0) {
                w.kin.angleRow(rod.model, rod::locate(rod.model, f.s), turn);
                w.load += f.torque * turn.transpose();
            }
        }
        w.rhs += dt * w.load;
    }
    w.mouseJoints.resize(rod.mouseJoints.size());
    for (std::size_t i = 0; i < rod.mouseJoints.size(); ++i) {
        const MouseJoint& g = rod.mouseJoints[i];
        MouseJointWork& k = w.mouseJoints[i];
        rowsAt(rod, w, g.s, k.J);
        k.stretch = g.target - rod.kin.point(rod::locate(rod.model, g.s));
        SC_ASSERT(k.J.cols() == rod.model.dofs(), "a row of this rod");
        k.stiffness = g.stiffness;
        k.damping = g.damping;
        const double share = shareOf(g, forceOf(k, dt, first ? rod.v : w.v));
        k.stiffness *= share;
        k.damping *= share;
        w.A.noalias() += (dt * (k.damping + dt * k.stiffness)) * k.J.transpose() * k.J;
        w.rhs += (dt * k.stiffness) * (k.J.transpose() * k.stretch);
    }
}

double recordAppliedForces(Rod& rod, double dt, const RodWork& w) {
    double work = w.load.size() > 0 ? dt * w.load.dot(w.v) : 0.0;
    SC_ASSERT(w.mouseJoints.size() == rod.mouseJoints.size(), "one work space a mouse joint");
    for (std::size_t i = 0; i < w.mouseJoints.size(); ++i) {
        rod.mouseJoints[i].force = forceOf(w.mouseJoints[i], dt, w.v);
        work += dt * rod.mouseJoints[i].force.dot(w.mouseJoints[i].J * w.v);
    }
    return work;
}

MouseForce mouseForce(const MouseJoint& g, const Vec2& point, const Vec2& velocity) {
    const Vec2 whole = g.stiffness * (g.target - point) - g.damping * velocity;
    const double share = shareOf(g, whole);
    return {share * whole, share};
}

void recordMouseForces(Rod& rod, RodWork& w) {
    for (MouseJoint& g : rod.mouseJoints) {
        rowsAt(rod, w, g.s, w.rowsOfLoad);
        g.force = mouseForce(g, w.kin.point(rod::locate(rod.model, g.s)), w.rowsOfLoad * w.v).force;
    }
}

bool mouseJointsOff(const Rod& rod, double dt, const RodWork& w) {
    for (std::size_t i = 0; i < w.mouseJoints.size(); ++i) {
        const MouseJoint& g = rod.mouseJoints[i];
        const MouseJointWork& k = w.mouseJoints[i];
        const double force = forceOf(k, dt, w.v).norm();
        const bool scaled = k.stiffness < g.stiffness || k.damping < g.damping;
        if (force > 1.01 * g.maxForce || (scaled && force < 0.99 * g.maxForce))
            return true;
    }
    return false;
}

} // namespace supercircle::step
