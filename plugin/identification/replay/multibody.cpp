#include "plugin/identification/replay/multibody.h"
#include "supercircle/support/dense.h"
#include "supercircle/support/trig.h"

#include <algorithm>
#include <cmath>

namespace supercircle::replay {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using rod::Vec2;

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}
Vec2 rotated(const Vec2& v, double angle) {
    const double c = math::cos(angle), s = math::sin(angle);
    return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}
Vec2 crossSpin(double spin, const Vec2& r) {
    return {-spin * r.y(), spin * r.x()};
}

/// Solves A x = b, symmetric. With redundant joints (closed loops) any solution is accepted.
VectorXd solved(const MatrixXd& a, const VectorXd& b) {
    if (a.rows() <= 3)
        return dense::solveLdlt(a, b);
    return dense::solveFullPivLu(a, b);
}

constexpr int kCircle = 64; ///< edges of a polygon for a circle in air: its drag is accurate to 1e-3

} // namespace

Multibody::Multibody(const step::RigidWorldDefinition& world, const effects::BodiesModel& extra)
    : extra_(extra), gravity_(world.gravity) {
    for (const step::BodyDefinition& d : world.bodies)
        if (failure_.empty())
            addBody(d);
    for (const step::JointDefinition& d : world.joints)
        if (failure_.empty())
            addJoint(d);
    if (failure_.empty() && moving_ == 0)
        failure_ = "no body of the scene can move";
    if (!failure_.empty())
        return;
    state_ = VectorXd::Zero(6 * moving_ + 2);
    inverseMass_ = VectorXd::Zero(3 * moving_);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Body& b = bodies_[i];
        if (b.moving < 0)
            continue;
        const Index at = 3 * b.moving;
        inverseMass_.segment<3>(at) << 1.0 / b.mass, 1.0 / b.mass, b.inverseInertia;
        const step::BodyDefinition& d = world.bodies[i];
        state_.segment<3>(at) << b.position, b.angle;
        const Vec2 r = rotated(b.centre, b.angle);
        state_.segment<3>(3 * moving_ + at) << d.linearVelocity + crossSpin(d.angularVelocity, r), d.angularVelocity;
    }
    if (jointGap() > 1e-3)
        failure_ =
            "the bodies do not meet in their joints: the largest gap is " + std::to_string(1e3 * jointGap()) + " mm";
    if (!failure_.empty())
        return;
    updateTurning(); // before projectJoints(), which needs to know sticking joints
    projectJoints();
    updateFriction();
}

void Multibody::addFixture(const step::FixtureDefinition& f, Body& body, bool massKnown, double& mass, Vec2& moment,
                           double& inertia) const {
    std::vector<Vec2> corners = f.vertices;
    bool closed = f.shape == step::ShapeKind::Polygon || f.shape == step::ShapeKind::Loop;
    if (f.shape == step::ShapeKind::Circle) {
        closed = true;
        corners.clear();
        for (int i = 0; i < kCircle; ++i)
            corners.push_back(f.centre + f.radius * rotated(Vec2::UnitX(), 2.0 * M_PI * i / kCircle));
        const double m = massKnown ? 0.0 : f.density * M_PI * f.radius * f.radius;
        mass += m;
        moment += m * f.centre;
        inertia += m * (0.5 * f.radius * f.radius + f.centre.squaredNorm());
    } else if (f.shape == step::ShapeKind::Polygon && !massKnown) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Vec2 a = corners[i], b = corners[(i + 1) % corners.size()];
            const double m = 0.5 * f.density * cross(a, b); // triangle with the origin
            mass += m;
            moment += m * (a + b) / 3.0;
            inertia += m * (a.squaredNorm() + a.dot(b) + b.squaredNorm()) / 6.0;
        }
    }
    if (f.sensor)
        return;
    const bool solidRight = f.shape == step::ShapeKind::Chain || f.shape == step::ShapeKind::Loop;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < corners.size(); ++i) {
        const Vec2 a = corners[i], b = corners[(i + 1) % corners.size()];
        const Vec2 t = (b - a).normalized();
        const Vec2 out = solidRight ? Vec2(-t.y(), t.x()) : Vec2(t.y(), -t.x());
        body.edges.push_back({a, b, out});
        if (f.twoSided)
            body.edges.push_back({b, a, -out});
    }
}

void Multibody::addBody(const step::BodyDefinition& d) {
    Body b;
    b.name = d.name;
    double mass = 0.0, inertia = 0.0; // about the origin
    Vec2 moment = Vec2::Zero();
    for (const step::FixtureDefinition& f : d.fixtures)
        addFixture(f, b, d.massData.has_value(), mass, moment, inertia);
    if (d.massData) {
        mass = d.massData->mass;
        moment = mass * d.massData->centre;
        inertia = d.massData->inertia;
    }
    const bool moves = d.type == step::BodyType::Dynamic && d.active;
    if (moves && !(mass > 0.0))
        failure_ = "body \"" + d.name + "\" has no mass";
    if (d.type == step::BodyType::Kinematic && (!d.linearVelocity.isZero(0.0) || d.angularVelocity != 0.0))
        failure_ = "body \"" + d.name + "\" is kinematic; free scenes have no driven bodies";
    b.mass = mass;
    b.centre = mass > 0.0 ? Vec2(moment / mass) : Vec2(Vec2::Zero());
    b.inertia = inertia - mass * b.centre.squaredNorm();
    b.inverseInertia = d.fixedRotation || !(b.inertia > 0.0) ? 0.0 : 1.0 / b.inertia;
    b.linearDamping = d.linearDamping;
    b.angularDamping = d.angularDamping;
    b.gravityScale = d.gravityScale;
    b.angle = d.angle;
    b.position = d.position + rotated(b.centre, d.angle);
    for (Edge& e : b.edges) {
        e.from -= b.centre;
        e.to -= b.centre;
    }
    if (moves)
        b.moving = static_cast<int>(moving_++);
    bodies_.push_back(std::move(b));
}

void Multibody::addJoint(const step::JointDefinition& d) {
    const auto count = static_cast<std::int32_t>(bodies_.size());
    if (d.bodyA < 0 || d.bodyB < 0 || d.bodyA >= count || d.bodyB >= count)
        return;
    const bool soft = d.kind == step::JointKind::Weld && d.frequency > 0.0;
    if ((d.kind != step::JointKind::Revolute && d.kind != step::JointKind::Weld) || soft || d.enableLimit ||
        (d.enableMotor && d.maxMotorForce > 0.0)) {
        failure_ =
            "joint \"" + d.name + "\": free scenes support revolute joints and stiff welds without limits or motors";
        return;
    }
    Joint j;
    j.a = d.bodyA;
    j.b = d.bodyB;
    j.onA = d.anchorA - bodies_[static_cast<std::size_t>(d.bodyA)].centre;
    j.onB = d.anchorB - bodies_[static_cast<std::size_t>(d.bodyB)].centre;
    j.weld = d.kind == step::JointKind::Weld;
    j.refAngle = d.refAngle;
    joints_.push_back(j);
}

Vec2 Multibody::positionOf(const Body& b, const VectorXd& y) const {
    return b.moving < 0 ? b.position : Vec2(y.segment<2>(3 * b.moving));
}

double Multibody::angleOf(const Body& b, const VectorXd& y) const {
    return b.moving < 0 ? b.angle : y[3 * b.moving + 2];
}

double Multibody::relativeSpin(const Joint& j, const VectorXd& y) const {
    const auto spin = [&](int body) {
        const int m = bodies_[static_cast<std::size_t>(body)].moving;
        return m < 0 ? 0.0 : y[3 * moving_ + 3 * m + 2];
    };
    return spin(j.b) - spin(j.a);
}

/// Rows: two per joint, one more per weld, and one per sticking joint if `withResting`. `bias` is dJ/dt v.
void Multibody::jacobian(const VectorXd& y, MatrixXd& J, VectorXd& bias, bool withResting) const {
    Index rows = 0;
    for (const Joint& j : joints_)
        rows += 2 + (j.weld || (withResting && j.turning == 0) ? 1 : 0);
    J.setZero(rows, 3 * moving_);
    bias.setZero(rows);
    Index at = 0;
    for (const Joint& j : joints_) {
        const bool turns = !j.weld && !(withResting && j.turning == 0);
        for (const int side : {-1, 1}) {
            const Body& b = bodies_[static_cast<std::size_t>(side < 0 ? j.a : j.b)];
            if (b.moving < 0)
                continue;
            const Index c = 3 * b.moving;
            const Vec2 r = rotated(side < 0 ? j.onA : j.onB, angleOf(b, y));
            const double w = y[3 * moving_ + c + 2], s = side;
            J(at, c) = s;
            J(at + 1, c + 1) = s;
            J(at, c + 2) = -s * r.y();
            J(at + 1, c + 2) = s * r.x();
            bias.segment<2>(at) -= s * w * w * r;
            if (!turns)
                J(at + 2, c + 2) = s;
        }
        at += turns ? 2 : 3;
    }
}

/// Air pressure on edges that move outwards. The normal speed is linear on an edge, so three Gauss points on its
/// positive part are exact.
void Multibody::airOn(const Body& b, const VectorXd& y, VectorXd& force, double& power) const {
    const Index at = 3 * b.moving;
    const Vec2 v = y.segment<2>(3 * moving_ + at);
    const double w = y[3 * moving_ + at + 2], angle = angleOf(b, y);
    const Vec2 drift = rotated(v, -angle); // in the body frame
    Vec2 sum = Vec2::Zero();
    double torque = 0.0;
    for (const Edge& e : b.edges) {
        const Vec2 way = e.to - e.from;
        const double v0 = (drift + crossSpin(w, e.from)).dot(e.normal), v1 = (drift + crossSpin(w, e.to)).dot(e.normal);
        if (v0 <= 0.0 && v1 <= 0.0)
            continue;
        const double from = v0 < 0.0 ? v0 / (v0 - v1) : 0.0, to = v1 < 0.0 ? v0 / (v0 - v1) : 1.0;
        constexpr double kAt[] = {-0.7745966692414834, 0.0, 0.7745966692414834},
                         kWeight[] = {5.0 / 18, 4.0 / 9, 5.0 / 18};
        for (int g = 0; g < 3; ++g) {
            const double s = 0.5 * (from + to) + 0.5 * (to - from) * kAt[g];
            const double speed = v0 + s * (v1 - v0);
            const double p = (extra_.airLinear + extra_.airQuadratic * speed) * speed;
            const double f = p * kWeight[g] * (to - from) * way.norm();
            sum -= f * e.normal;
            torque -= f * cross(e.from + s * way, e.normal);
        }
    }
    const Vec2 total = rotated(sum, angle) - b.mass * b.linearDamping * v;
    const double turning = torque - b.inertia * b.angularDamping * w;
    force.segment<2>(at) += total;
    force[at + 2] += turning;
    power -= total.dot(v) + turning * w;
}

Multibody::Rates Multibody::rates(const VectorXd& y) const {
    const Index n = 3 * moving_;
    const bool dryOn = extra_.bearingTorque > 0.0 || extra_.bearingArm > 0.0;
    VectorXd force = VectorXd::Zero(n);
    double intoAir = 0.0, intoBearings = 0.0;
    for (const Body& b : bodies_)
        if (b.moving >= 0) {
            force.segment<2>(3 * b.moving) += b.mass * b.gravityScale * gravity_;
            airOn(b, y, force, intoAir);
        }
    const auto addTorque = [&](const Joint& j, double torque, VectorXd& f) { // on b, opposite on a
        if (const int m = bodies_[static_cast<std::size_t>(j.b)].moving; m >= 0)
            f[3 * m + 2] += torque;
        if (const int m = bodies_[static_cast<std::size_t>(j.a)].moving; m >= 0)
            f[3 * m + 2] -= torque;
    };
    for (const Joint& j : joints_)
        if (!j.weld) {
            const double w = relativeSpin(j, y);
            addTorque(j, -extra_.bearingViscosity * w, force);
            intoBearings += extra_.bearingViscosity * w * w;
        }
    Rates out;
    out.holdingTorque = out.dryTorque = VectorXd::Zero(static_cast<Index>(joints_.size()));
    out.dryTorque.setConstant(extra_.bearingTorque);
    MatrixXd J;
    VectorXd bias, total, reaction;
    jacobian(y, J, bias, dryOn);
    const MatrixXd WJ = inverseMass_.asDiagonal() * J.transpose();
    const MatrixXd A = J * WJ;
    constexpr int kMost = 50; // friction torque proportional to the reaction: a contraction by arm / length each round
    for (int round = 0; round < kMost; ++round) {
        total = force;
        for (std::size_t i = 0; i < joints_.size() && dryOn; ++i)
            if (!joints_[i].weld && joints_[i].turning != 0)
                addTorque(joints_[i], -joints_[i].turning * out.dryTorque[static_cast<Index>(i)], total);
        reaction = J.rows() > 0 ? solved(A, -bias - WJ.transpose() * total) : VectorXd();
        double change = 0.0;
        Index at = 0;
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            const Joint& j = joints_[i];
            const auto k = static_cast<Index>(i);
            const double dryTorque = extra_.bearingTorque + extra_.bearingArm * reaction.segment<2>(at).norm();
            change = std::max(change, std::abs(dryTorque - out.dryTorque[k]) - 1e-13 * dryTorque);
            out.dryTorque[k] = dryTorque;
            const bool three = j.weld || (dryOn && j.turning == 0);
            out.holdingTorque[k] = three && !j.weld ? reaction[at + 2] : 0.0;
            at += three ? 3 : 2;
        }
        if (extra_.bearingArm <= 0.0 || change <= 0.0)
            break;
    }
    for (std::size_t i = 0; i < joints_.size() && dryOn; ++i)
        if (!joints_[i].weld)
            intoBearings += joints_[i].turning * out.dryTorque[static_cast<Index>(i)] * relativeSpin(joints_[i], y);
    out.of.resize(y.size());
    out.of.head(n) = y.segment(n, n);
    out.of.segment(n, n) = inverseMass_.cwiseProduct(total);
    if (J.rows() > 0)
        out.of.segment(n, n) += WJ * reaction;
    out.of[2 * n] = intoBearings;
    out.of[2 * n + 1] = intoAir;
    return out;
}

VectorXd Multibody::rungeKuttaStep(double h) const {
    const VectorXd k1 = rates(state_).of;
    const VectorXd k2 = rates(state_ + 0.5 * h * k1).of;
    const VectorXd k3 = rates(state_ + 0.5 * h * k2).of;
    const VectorXd k4 = rates(state_ + h * k3).of;
    return state_ + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

/// Projects positions and velocities onto the joints, weighted by mass.
void Multibody::projectJoints() {
    if (joints_.empty())
        return;
    MatrixXd J;
    VectorXd bias;
    const Index n = 3 * moving_;
    constexpr int kRounds = 2; // Newton: gaps of 1e-9 m fall to 1e-18
    for (int round = 0; round < kRounds; ++round) {
        jacobian(state_, J, bias, false);
        VectorXd gap = VectorXd::Zero(J.rows());
        Index at = 0;
        for (const Joint& j : joints_) {
            const Body &a = bodies_[static_cast<std::size_t>(j.a)], &b = bodies_[static_cast<std::size_t>(j.b)];
            gap.segment<2>(at) = positionOf(b, state_) + rotated(j.onB, angleOf(b, state_)) - positionOf(a, state_) -
                                 rotated(j.onA, angleOf(a, state_));
            if (j.weld)
                gap[at + 2] = angleOf(b, state_) - angleOf(a, state_) - j.refAngle;
            at += j.weld ? 3 : 2;
        }
        const MatrixXd WJ = inverseMass_.asDiagonal() * J.transpose();
        state_.head(n) -= WJ * solved(J * WJ, gap);
    }
    jacobian(state_, J, bias, extra_.bearingTorque > 0.0 || extra_.bearingArm > 0.0);
    const MatrixXd WJ = inverseMass_.asDiagonal() * J.transpose();
    state_.segment(n, n) -= WJ * solved(J * WJ, J * state_.segment(n, n));
}

/// A joint with relative spin slides.
void Multibody::updateTurning() {
    constexpr double kNone = 1e-12; // rad/s
    for (Joint& j : joints_)
        if (j.turning == 0 && std::abs(relativeSpin(j, state_)) > kNone)
            j.turning = relativeSpin(j, state_) > 0.0 ? 1 : -1;
}

/// Determines which joints stick and the sliding direction of the others: a joint without spin sticks if its friction
/// torque suffices, otherwise it starts against the torque that would hold it.
void Multibody::updateFriction() {
    if (extra_.bearingTorque <= 0.0 && extra_.bearingArm <= 0.0)
        return;
    updateTurning();
    for (std::size_t round = 0; round <= joints_.size(); ++round) {
        const Rates now = rates(state_);
        Index worst = -1;
        double most = 1.0;
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            const auto k = static_cast<Index>(i);
            const double share = now.dryTorque[k] > 0.0 ? std::abs(now.holdingTorque[k]) / now.dryTorque[k] : 2.0;
            if (!joints_[i].weld && joints_[i].turning == 0 && share > most) {
                worst = k;
                most = share;
            }
        }
        if (worst < 0)
            return;
        joints_[static_cast<std::size_t>(worst)].turning = now.holdingTorque[worst] > 0.0 ? -1 : 1;
    }
}

void Multibody::advance(double step) {
    const bool dryOn = extra_.bearingTorque > 0.0 || extra_.bearingArm > 0.0;
    double h = step;
    VectorXd next = rungeKuttaStep(h);
    Joint* stops = nullptr;
    for (Joint& j : joints_) {
        if (!dryOn || j.weld || j.turning == 0 || relativeSpin(j, next) * j.turning >= 0.0)
            continue;
        // Bisection for zero spin, because shortly after a reversal the spin is near zero at both ends.
        double from = 0.0, to = h;
        for (int i = 0; i < 60 && to - from > 1e-15 * step; ++i) {
            const double middle = 0.5 * (from + to);
            (relativeSpin(j, rungeKuttaStep(middle)) * j.turning > 0.0 ? from : to) = middle;
        }
        h = to;
        next = rungeKuttaStep(h);
        stops = &j;
    }
    state_ = next;
    time_ += h;
    ++steps_;
    if (stops != nullptr)
        stops->turning = 0;
    projectJoints();
    if (dryOn)
        updateFriction();
}

int Multibody::find(const std::string& name) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i)
        if (bodies_[i].name == name)
            return static_cast<int>(i);
    return -1;
}

Multibody::Pose Multibody::pose(int body) const {
    const Body& b = bodies_[static_cast<std::size_t>(body)];
    Pose p;
    p.angle = angleOf(b, state_);
    const Vec2 r = rotated(b.centre, p.angle);
    p.origin = positionOf(b, state_) - r;
    if (b.moving >= 0) {
        p.spin = state_[3 * moving_ + 3 * b.moving + 2];
        p.velocity = Vec2(state_.segment<2>(3 * moving_ + 3 * b.moving)) - crossSpin(p.spin, r);
    }
    return p;
}

double Multibody::energy() const {
    double sum = 0.0;
    for (const Body& b : bodies_)
        if (b.moving >= 0) {
            const Vec2 v = state_.segment<2>(3 * moving_ + 3 * b.moving);
            const double w = state_[3 * moving_ + 3 * b.moving + 2];
            sum += 0.5 * b.mass * v.squaredNorm() + 0.5 * b.inertia * w * w -
                   b.mass * b.gravityScale * gravity_.dot(positionOf(b, state_));
        }
    return sum;
}

double Multibody::mass() const {
    double sum = 0.0;
    for (const Body& b : bodies_)
        sum += b.moving >= 0 ? b.mass : 0.0;
    return sum;
}

double Multibody::reach() const {
    double most = 0.0;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const Body& b = bodies_[i];
        for (std::size_t k = 0; b.moving >= 0 && k < b.edges.size(); ++k) {
            double nearest = b.edges[k].from.norm() + b.centre.norm(); // without joints: from its origin
            for (const Joint& j : joints_)
                if (j.a == static_cast<int>(i) || j.b == static_cast<int>(i))
                    nearest =
                        std::min(nearest, (b.edges[k].from - (j.a == static_cast<int>(i) ? j.onA : j.onB)).norm());
            most = std::max(most, nearest);
        }
    }
    return most > 0.0 ? most : 0.1;
}

double Multibody::jointGap() const {
    double most = 0.0;
    for (const Joint& j : joints_) {
        const Body &a = bodies_[static_cast<std::size_t>(j.a)], &b = bodies_[static_cast<std::size_t>(j.b)];
        const Vec2 gap = positionOf(b, state_) + rotated(j.onB, angleOf(b, state_)) - positionOf(a, state_) -
                         rotated(j.onA, angleOf(a, state_));
        most = std::max(most, gap.norm());
    }
    return most;
}

} // namespace supercircle::replay
