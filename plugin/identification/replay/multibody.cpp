#include "plugin/identification/replay/multibody.h"
#include "plugin/identification/replay/plane.h"
#include "supercircle/support/dense.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supercircle::replay {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using rod::Vec2;

/// Solves A x = b, symmetric. With redundant joints (closed loops) any solution is accepted.
VectorXd solved(const MatrixXd& a, const VectorXd& b) {
    if (a.rows() == 0)
        return {};
    if (a.rows() <= 3)
        return dense::solveLdlt(a, b);
    return dense::solveFullPivLu(a, b);
}

} // namespace

Multibody::Multibody(const step::RigidWorldDefinition& world, const effects::BodiesModel& extra,
                     const effects::FrictionModel& friction)
    : extra_(extra), friction_(friction), gravity_(world.gravity) {
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
    state_ = VectorXd::Zero(6 * moving_ + 3);
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
    constexpr double kMeets = 0.01, kPoint = 0.1; // of the length of the largest body, m for bodies without shape
    if (jointGap() > kMeets * (reach() > 0.0 ? reach() : kPoint))
        failure_ =
            "the bodies do not meet in their joints: the largest gap is " + std::to_string(1e3 * jointGap()) + " mm";
    if (!failure_.empty())
        return;
    updateTurning(); // before projectJoints(), which needs to know sticking joints
    projectJoints(true);
    updateFriction();
}

void Multibody::drive(int body, const Vec2& direction, std::vector<double> time, std::vector<double> displacement) {
    driven_ = body;
    direction_ = direction;
    driveTime_ = std::move(time);
    driveDisplacement_ = std::move(displacement);
    segment_ = 1;
    time_ = state_[timeIndex()] = driveTime_.front();
    projectJoints(false); // the drive may start at any speed
    updateTurning();
    projectJoints(true);
    updateFriction();
}

Multibody::Motion Multibody::motionOf(const Body& b, const VectorXd& y) const {
    if (b.moving >= 0)
        return {y.segment<2>(3 * b.moving), y.segment<2>(3 * moving_ + 3 * b.moving), y[3 * b.moving + 2],
                y[3 * moving_ + 3 * b.moving + 2]};
    const double t = y[timeIndex()];
    if (driven_ < 0 || &b != &bodies_[static_cast<std::size_t>(driven_)])
        return {b.position + t * b.velocity, b.velocity, b.angle + t * b.spin, b.spin};
    const double speed = (driveDisplacement_[segment_] - driveDisplacement_[segment_ - 1]) /
                         (driveTime_[segment_] - driveTime_[segment_ - 1]);
    const double way = driveDisplacement_[segment_ - 1] + speed * (t - driveTime_[segment_ - 1]);
    return {b.position + way * direction_, speed * direction_, b.angle, 0.0};
}

Multibody::Rates Multibody::rates(const VectorXd& y) const {
    const Index n = 3 * moving_;
    const double since = y[timeIndex()] - time_;
    const bool dryOn = anyDryFriction();
    VectorXd force = VectorXd::Zero(n);
    double intoAir = 0.0, intoJoints = 0.0;
    for (const Body& b : bodies_)
        if (b.moving >= 0) {
            force.segment<2>(3 * b.moving) += b.mass * b.gravityScale * gravity_;
            airOn(b, y, force, intoAir);
        }
    Rates out;
    std::vector<Coordinate> ways;
    for (const Joint& j : joints_) {
        ways.push_back(j.free() || j.springs ? coordinate(j, y) : Coordinate{});
        const Coordinate& c = ways.back();
        const double viscosity = viscosityOf(j, c.rate);
        const double x = c.value - j.spring.rest;
        const double elastic = j.spring.stiffness * x * (1.0 + cubicOf(j) * x * x);
        if (viscosity != 0.0 || elastic != 0.0)
            apply(j, c.row, -elastic - viscosity * c.rate, force, out.onDriven);
        intoJoints += viscosity * c.rate * c.rate;
    }
    const auto count = static_cast<Index>(joints_.size());
    out.holding = out.dry = VectorXd::Zero(count);
    for (std::size_t i = 0; i < joints_.size(); ++i)
        out.dry[static_cast<Index>(i)] = dryFriction(joints_[i], 0.0, ways[i].rate, since);
    const Rows rows = rowsAt(y, dryOn);
    const MatrixXd WJ = inverseMass_.asDiagonal() * rows.J.transpose();
    const MatrixXd A = rows.J * WJ;
    VectorXd total, reaction;
    Eigen::Vector3d sliding;
    constexpr int kMost = 50; // friction torque proportional to the reaction: a contraction by arm / length each round
    for (int round = 0; round < kMost; ++round) {
        total = force;
        sliding.setZero();
        for (std::size_t i = 0; i < joints_.size() && dryOn; ++i)
            if (hasDryFriction(joints_[i]) && joints_[i].turning != 0)
                apply(joints_[i], ways[i].row, -joints_[i].turning * out.dry[static_cast<Index>(i)], total, sliding);
        reaction = solved(A, -rows.bias - WJ.transpose() * total);
        double change = 0.0;
        Index at = 0;
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            const Joint& j = joints_[i];
            const auto k = static_cast<Index>(i);
            const auto own = static_cast<Index>(rowsOf(j));
            const double dry = dryFriction(j, own > 0 ? reaction.segment(at, own).norm() : 0.0, ways[i].rate, since);
            change = std::max(change, std::abs(dry - out.dry[k]) - 1e-13 * dry);
            out.dry[k] = dry;
            const bool sticks = dryOn && hasDryFriction(j) && j.turning == 0;
            out.holding[k] = sticks ? reaction[at + own] : 0.0;
            at += own + (sticks ? 1 : 0);
        }
        if (extra_.bearingArm <= 0.0 || change <= 0.0)
            break;
    }
    out.onDriven += sliding;
    if (driven_ >= 0 && reaction.size() > 0)
        out.onDriven += rows.driven.transpose() * reaction;
    for (std::size_t i = 0; i < joints_.size() && dryOn; ++i)
        if (hasDryFriction(joints_[i]))
            intoJoints += joints_[i].turning * out.dry[static_cast<Index>(i)] * ways[i].rate;
    out.of.resize(y.size());
    out.of.head(n) = y.segment(n, n);
    out.of.segment(n, n) = inverseMass_.cwiseProduct(total);
    if (rows.J.rows() > 0)
        out.of.segment(n, n) += WJ * reaction;
    out.of[2 * n] = intoJoints;
    out.of[2 * n + 1] = intoAir;
    out.of[2 * n + 2] = 1.0;
    return out;
}

VectorXd Multibody::rungeKuttaStep(double h) const {
    const VectorXd k1 = rates(state_).of;
    const VectorXd k2 = rates(state_ + 0.5 * h * k1).of;
    const VectorXd k3 = rates(state_ + 0.5 * h * k2).of;
    const VectorXd k4 = rates(state_ + h * k3).of;
    return state_ + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

/// Friction that grows with the logarithm of the speed is stiff where that is small: a creeping block reaches its speed
/// in microseconds. Where a step is longer, the friction is that of its end, constant over the step. The speed at the
/// end falls in proportion to it, so that two steps say which one agrees with its law.
void Multibody::holdStiffFriction(double h) {
    // Steps over the time of an e-fold. Half changes the force by 1e-10 and the time not at all; double moves the peak
    // after a rest by 1e-4 of it.
    constexpr double kStiff = 0.5;
    constexpr int kHalvings = 60;
    constexpr double kAtRest = 1e-3; // of the creep speed
    if (friction_.direct <= 0.0)
        return;
    for (Joint& j : joints_) {
        if (!hasDryFriction(j) || j.turning == 0 || j.sliding <= 0.0)
            continue;
        const Coordinate c = coordinate(j, state_);
        const double speed = std::max(0.0, j.turning * c.rate);
        if (h * mobility(c, j) * j.sliding * friction_.direct / (speed + friction_.stateCreep) < kStiff)
            continue;
        const auto factor = [&](double v) { return effects::frictionFactor(friction_, j.site, std::max(0.0, v), h); };
        const auto speedBehind = [&](double held) {
            j.held = held;
            return j.turning * relativeRate(j, rungeKuttaStep(h));
        };
        double low = factor(0.0);
        const double fast = speedBehind(low);
        if (fast <= 0.0) { // it stops, or does not start: its contacts age faster than the force grows
            if (speed <= kAtRest * friction_.stateCreep) {
                j.turning = 0;
                j.held = -1.0;
            }
            continue;
        }
        double high = std::max(factor(fast), low * (1.0 + 1e-6));
        const double slope = (fast - speedBehind(high)) / (high - low), first = low;
        for (int i = 0; i < kHalvings && high - low > 1e-14 * high; ++i) {
            const double middle = 0.5 * (low + high);
            (factor(fast - slope * (middle - first)) > middle ? low : high) = middle;
        }
        j.held = 0.5 * (low + high);
    }
}

/// Projects positions and velocities onto the joints, weighted by mass.
void Multibody::projectJoints(bool withResting) {
    if (joints_.empty())
        return;
    const Index n = 3 * moving_;
    constexpr int kRounds = 2; // Newton: gaps of 1e-9 m fall to 1e-18
    for (int round = 0; round < kRounds; ++round) {
        const Rows rows = rowsAt(state_, false);
        if (rows.J.rows() == 0)
            break;
        VectorXd gap(rows.J.rows());
        Index at = 0;
        for (const Joint& j : joints_) {
            const VectorXd own = gapsOf(j, state_);
            gap.segment(at, own.size()) = own;
            at += own.size();
        }
        const MatrixXd WJ = inverseMass_.asDiagonal() * rows.J.transpose();
        state_.head(n) -= WJ * solved(rows.J * WJ, gap);
    }
    const Rows rows = rowsAt(state_, withResting && anyDryFriction());
    if (rows.J.rows() == 0)
        return;
    const MatrixXd WJ = inverseMass_.asDiagonal() * rows.J.transpose();
    state_.segment(n, n) -= WJ * solved(rows.J * WJ, rows.J * state_.segment(n, n) + rows.given);
}

/// A joint in relative motion slides.
void Multibody::updateTurning() {
    constexpr double kNone = 1e-12; // rad/s, m/s
    for (Joint& j : joints_)
        if (j.free() && j.turning == 0 && std::abs(relativeRate(j, state_)) > kNone)
            j.turning = relativeRate(j, state_) > 0.0 ? 1 : -1;
}

/// Determines which joints stick and the sliding direction of the others: a joint without relative motion sticks if its
/// friction suffices, otherwise it starts against the force that would hold it.
void Multibody::updateFriction() {
    if (!anyDryFriction())
        return;
    updateTurning();
    for (std::size_t round = 0; round <= joints_.size(); ++round) {
        const Rates now = rates(state_);
        Index worst = -1;
        double most = 1.0;
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            const auto k = static_cast<Index>(i);
            const double share = now.dry[k] > 0.0 ? std::abs(now.holding[k]) / now.dry[k] : 2.0;
            if (hasDryFriction(joints_[i]) && joints_[i].turning == 0 && share > most) {
                worst = k;
                most = share;
            }
        }
        if (worst < 0)
            return;
        joints_[static_cast<std::size_t>(worst)].turning = now.holding[worst] > 0.0 ? -1 : 1;
    }
}

bool Multibody::slips(std::size_t joint, const VectorXd& y) const {
    const Rates there = rates(y);
    const auto k = static_cast<Index>(joint);
    return std::abs(there.holding[k]) > there.dry[k] * (1.0 + 1e-12);
}

Multibody::Joint* Multibody::firstEvent(double& h, VectorXd& next) {
    Joint* first = nullptr;
    const double step = h;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
        Joint& j = joints_[i];
        if (!hasDryFriction(j))
            continue;
        const bool rests = j.turning == 0;
        const auto happened = [&](const VectorXd& y) {
            return rests ? slips(i, y) : relativeRate(j, y) * j.turning < 0.0;
        };
        if (!happened(next))
            continue;
        // Bisection: shortly after a reversal the rate is near zero at both ends.
        double from = 0.0, to = h;
        for (int k = 0; k < 60 && to - from > 1e-15 * step; ++k) {
            const double middle = 0.5 * (from + to);
            const VectorXd there = rungeKuttaStep(middle);
            const bool before = rests ? !slips(i, there) : relativeRate(j, there) * j.turning > 0.0;
            (before ? from : to) = middle;
        }
        h = to;
        next = rungeKuttaStep(h);
        first = &j;
    }
    return first;
}

void Multibody::advance(double step) {
    double h = step;
    bool turns = false; // the drive changes its speed at the end of the step
    if (driven_ >= 0 && segment_ + 1 < driveTime_.size() && time_ + h >= driveTime_[segment_]) {
        h = driveTime_[segment_] - time_;
        turns = true;
    }
    holdStiffFriction(h);
    VectorXd next = rungeKuttaStep(h);
    Joint* const event = anyDryFriction() ? firstEvent(h, next) : nullptr;
    for (Joint& j : joints_)
        if (friction_.on() && hasDryFriction(j))
            effects::advance(friction_, j.site,
                             0.5 * (std::abs(relativeRate(j, state_)) + std::abs(relativeRate(j, next))), h);
    for (Joint& j : joints_)
        j.held = -1.0;
    state_ = next;
    time_ += h;
    ++steps_;
    if (event != nullptr) {
        turns = false;
        if (event->turning != 0)
            event->turning = 0;
    }
    if (turns) {
        time_ = driveTime_[segment_++];
        state_[timeIndex()] = time_;
        projectJoints(false);
        updateTurning();
    }
    state_[timeIndex()] = time_;
    projectJoints(true);
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
    const Motion m = motionOf(b, state_);
    Pose p;
    p.angle = m.angle;
    const Vec2 r = rotated(b.centre, p.angle);
    p.origin = m.position - r;
    p.spin = m.spin;
    p.velocity = m.velocity - crossSpin(p.spin, r);
    return p;
}

Multibody::Forces Multibody::forces(int body) const {
    const Rates now = rates(state_);
    Forces out;
    out.machine = -now.onDriven.head<2>().dot(direction_);
    const Body& b = bodies_[static_cast<std::size_t>(body)];
    if (b.moving >= 0) {
        const Index at = 3 * moving_ + 3 * b.moving;
        const Vec2 r = rotated(b.centre, motionOf(b, state_).angle);
        const double w = state_[at + 2];
        out.angularAcceleration = now.of[at + 2];
        out.acceleration = Vec2(now.of.segment<2>(at)) - crossSpin(out.angularAcceleration, r) + w * w * r;
    }
    return out;
}

double Multibody::travel() const {
    if (driven_ < 0)
        return 0.0;
    const Body& b = bodies_[static_cast<std::size_t>(driven_)];
    return (motionOf(b, state_).position - b.position).dot(direction_);
}

/// Rate of a coordinate over an impulse along it, without other joints: not less than with them, 1/kg or 1/(kg m^2).
double Multibody::mobility(const Coordinate& c, const Joint& j) const {
    double sum = 0.0;
    for (const auto& [body, row] : {std::pair{j.a, &c.row.a}, std::pair{j.b, &c.row.b}})
        if (const int m = bodies_[static_cast<std::size_t>(body)].moving; m >= 0)
            sum += row->cwiseAbs2().dot(inverseMass_.segment<3>(3 * m));
    return sum;
}

double Multibody::shortestTime() const {
    double most = 0.0; // 1/s
    for (const Joint& j : joints_) {
        if (!j.spring.on())
            continue;
        const Coordinate c = coordinate(j, state_);
        const double x = c.value - j.spring.rest, stiffness = j.spring.stiffness * (1.0 + 3.0 * cubicOf(j) * x * x);
        most =
            std::max({most, std::sqrt(std::abs(stiffness) * mobility(c, j)), viscosityOf(j, c.rate) * mobility(c, j)});
    }
    return most > 0.0 ? 1.0 / most : std::numeric_limits<double>::infinity();
}

double Multibody::stiffness() const {
    double most = 0.0;
    for (const Joint& j : joints_)
        if (j.spring.stiffness > 0.0)
            most = std::max(most, std::sqrt(j.spring.stiffness * mobility(coordinate(j, state_), j)));
    return most;
}

Multibody::Elongations Multibody::elongations() const {
    Elongations out;
    for (const Joint& j : joints_) {
        if (!j.spring.on())
            continue;
        const double x = std::abs(coordinate(j, state_).value - j.spring.rest);
        const double pull = std::abs(j.spring.stiffness * x * (1.0 + cubicOf(j) * x * x));
        const bool turning = j.kind == step::JointKind::Revolute;
        (turning ? out.angle : out.length) = std::max(turning ? out.angle : out.length, x);
        (turning ? out.torque : out.force) = std::max(turning ? out.torque : out.force, pull);
    }
    return out;
}

double Multibody::energy() const {
    double sum = 0.0;
    for (const Body& b : bodies_)
        if (b.moving >= 0) {
            const Motion m = motionOf(b, state_);
            sum += 0.5 * b.mass * m.velocity.squaredNorm() + 0.5 * b.inertia * m.spin * m.spin -
                   b.mass * b.gravityScale * gravity_.dot(m.position);
        }
    for (const Joint& j : joints_)
        if (j.spring.on()) {
            const double x = coordinate(j, state_).value - j.spring.rest;
            sum += 0.5 * j.spring.stiffness * x * x * (1.0 + 0.5 * cubicOf(j) * x * x);
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
    return most;
}

double Multibody::jointGap() const {
    double most = 0.0;
    for (const Joint& j : joints_) {
        const VectorXd gaps = gapsOf(j, state_);
        const Index places = j.kind == step::JointKind::Revolute || j.kind == step::JointKind::Weld ? 2 : 1;
        if (gaps.size() > 0)
            most = std::max(most, gaps.head(places).norm());
    }
    return most;
}

} // namespace supercircle::replay
