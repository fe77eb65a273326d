// Bodies of a mechanism: mass, shape, drag of the air.

#include "plugin/identification/replay/multibody.h"
#include "plugin/identification/replay/plane.h"

#include <utility>

namespace supercircle::replay {

using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr int kCircle = 64; ///< edges of a polygon for a circle in air: its drag is accurate to 1e-3

} // namespace

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
    b.mass = mass;
    b.centre = mass > 0.0 ? Vec2(moment / mass) : Vec2(Vec2::Zero());
    b.inertia = inertia - mass * b.centre.squaredNorm();
    b.inverseInertia = d.fixedRotation || !(b.inertia > 0.0) ? 0.0 : 1.0 / b.inertia;
    b.linearDamping = d.linearDamping;
    b.angularDamping = d.angularDamping;
    b.gravityScale = d.gravityScale;
    b.angle = d.angle;
    b.position = d.position + rotated(b.centre, d.angle);
    if (d.type == step::BodyType::Kinematic) {
        b.spin = d.angularVelocity;
        b.velocity = d.linearVelocity + crossSpin(b.spin, rotated(b.centre, d.angle));
        if (b.spin != 0.0 && !b.centre.isZero(0.0))
            failure_ = "body \"" + d.name + "\" turns about a point off its centre of mass";
    }
    for (Edge& e : b.edges) {
        e.from -= b.centre;
        e.to -= b.centre;
    }
    if (moves)
        b.moving = static_cast<int>(moving_++);
    bodies_.push_back(std::move(b));
}

/// Air pressure on edges that move outwards. The normal speed is linear on an edge, so three Gauss points on its
/// positive part are exact.
void Multibody::airOn(const Body& b, const VectorXd& y, VectorXd& force, double& power) const {
    const Index at = 3 * b.moving;
    const Motion motion = motionOf(b, y);
    const Vec2 v = motion.velocity;
    const double w = motion.spin, angle = motion.angle;
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

} // namespace supercircle::replay
