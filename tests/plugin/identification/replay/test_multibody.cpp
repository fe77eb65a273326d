// Free mechanisms against closed forms: periods by elliptic integrals, decay by each kind of resistance, normal modes,
// energy.

#include "plugin/identification/replay/multibody.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace supercircle;
using replay::Multibody;
using step::Vec2;

namespace {

constexpr double kGravity = 9.81, kLength = 0.124, kMass = 0.01225, kStep = 2e-3;
const double kInertia = kMass * kLength * kLength / 3.0; ///< about the hinge
const double kWeight = kMass * kGravity * 0.5 * kLength; ///< m g d
const double kOmega = std::sqrt(kWeight / kInertia);     ///< rad/s, of small oscillations

step::BodyDefinition rod(const std::string& name, const Vec2& hinge, double angle, double spin = 0.0) {
    step::BodyDefinition d;
    d.name = name;
    d.type = step::BodyType::Dynamic;
    d.position = hinge;
    d.angle = angle;
    d.angularVelocity = spin;
    d.massData = step::MassData{kMass, Vec2(0.0, -0.5 * kLength), kInertia};
    step::FixtureDefinition f;
    f.vertices = {{-1e-9, -kLength}, {1e-9, -kLength}, {1e-9, 0.0}, {-1e-9, 0.0}};
    d.fixtures = {f};
    return d;
}

step::JointDefinition hinge(int a, int b, const Vec2& onA) {
    step::JointDefinition j;
    j.bodyA = a;
    j.bodyB = b;
    j.anchorA = onA;
    return j;
}

step::RigidWorldDefinition pendulum(double angle, double spin = 0.0) {
    step::RigidWorldDefinition w;
    w.bodies = {step::BodyDefinition{}, rod("rod", Vec2::Zero(), angle, spin)};
    w.joints = {hinge(0, 1, Vec2::Zero())};
    return w;
}

step::RigidWorldDefinition two(double upper, double lower) {
    step::RigidWorldDefinition w = pendulum(upper);
    const Vec2 knee(kLength * std::sin(upper), -kLength * std::cos(upper));
    w.bodies.push_back(rod("lower", knee, lower));
    w.joints.push_back(hinge(1, 2, {0.0, -kLength}));
    return w;
}

void play(Multibody& l, double until, double step = kStep) {
    while (l.time() < until - 1e-12)
        l.advance(std::min(step, until - l.time()));
}

/// Turning points (angles) of the pendulum. Dry friction ends a step there; otherwise the spin is linear to third
/// order.
std::vector<double> turns(Multibody& l, std::size_t count, double longest) {
    constexpr double kStopped = 1e-9; // rad/s
    std::vector<double> found;
    while (found.size() < count && l.time() < longest) {
        const Multibody::Pose a = l.pose(1);
        const double from = l.time();
        l.advance(kStep);
        const Multibody::Pose b = l.pose(1);
        if (std::abs(b.spin) < kStopped && std::abs(a.spin) > kStopped)
            found.push_back(b.angle);
        else if (a.spin * b.spin < 0.0 && std::abs(a.spin) > kStopped)
            found.push_back(a.angle + 0.5 * a.spin / (a.spin - b.spin) * a.spin * (l.time() - from));
    }
    return found;
}

} // namespace

TEST_CASE("the period of a pendulum is given by the elliptic integral", "[replay][free]") {
    for (const double angle : {0.01, 0.8, 1.6, 2.4, 3.0}) {
        Multibody l(pendulum(angle), {});
        REQUIRE(l.failure().empty());
        const double period = 4.0 / kOmega * std::comp_ellint_1(std::sin(0.5 * angle));
        play(l, 3.0 * period);
        INFO("released at " << angle << " rad");
        // At a turning point the angle is flat, so the spin tells the time: spin = - w0^2 sin(angle) dt.
        CHECK(std::abs(l.pose(1).spin) < kOmega * kOmega * std::sin(angle) * 1e-7 * period);
        CHECK(l.pose(1).angle == Approx(angle).epsilon(1e-7));
        CHECK(l.jointGap() < 1e-15);
    }
}

TEST_CASE("dry friction dissipates torque times angle in every half oscillation, then sticks", "[replay][free]") {
    effects::BodiesModel extra;
    extra.bearingTorque = 0.02 * kWeight;
    Multibody l(pendulum(1.2), extra);
    const std::vector<double> all = turns(l, 20, 20.0);
    REQUIRE(all.size() >= 15);
    double before = 1.2;
    for (const double now : all) { // work of gravity = torque times angle
        INFO("from " << before << " to " << now);
        CHECK(kWeight * (std::cos(now) - std::cos(before)) ==
              Approx(extra.bearingTorque * std::abs(now - before)).epsilon(1e-6));
        before = now;
    }
    // Small oscillations decay by 2 T / (m g d) each: linearly (sin of 0.5 rad is 4 % below 0.5).
    const std::size_t last = all.size() - 1;
    CHECK(std::abs(all[last - 6]) - std::abs(all[last - 1]) == Approx(5 * 0.04).epsilon(0.04));
    play(l, 30.0);
    CHECK(l.pose(1).spin == 0.0);
    CHECK(std::abs(std::sin(l.pose(1).angle)) <= 0.02);
    CHECK(std::abs(l.pose(1).angle) > 1e-6); // not at the frictionless equilibrium
    CHECK(l.energy() + l.jointLoss() == Approx(-kWeight * std::cos(1.2)).margin(1e-7 * kWeight)); // 2 ms steps
}

TEST_CASE("dry friction keeps the initial spin", "[replay][free]") {
    effects::BodiesModel extra;
    extra.bearingTorque = 0.02 * kWeight;
    for (const double spin : {-5.0, 0.3, 5.0}) {
        Multibody l(pendulum(0.5, spin), extra);
        CHECK(l.pose(1).spin == Approx(spin).epsilon(1e-12));
        const std::vector<double> all = turns(l, 1, 5.0);
        REQUIRE(all.size() == 1);
        // Work of gravity and of the torque up to the first turn, exactly.
        CHECK(kWeight * (std::cos(0.5) - std::cos(all[0])) ==
              Approx(0.5 * kInertia * spin * spin - extra.bearingTorque * std::abs(all[0] - 0.5)).epsilon(1e-6));
    }
}

TEST_CASE("viscous bearings give exponential decay of small oscillations", "[replay][free]") {
    effects::BodiesModel extra;
    const double rate = 0.3; // 1/s
    extra.bearingViscosity = 2.0 * rate * kInertia;
    Multibody l(pendulum(1e-4), extra);
    const double period = 2.0 * M_PI / std::sqrt(kOmega * kOmega - rate * rate);
    play(l, 5.0 * period);
    // x = A e^{-rate t} (cos + rate / w sin): after whole periods the cosine is 1. Small: the sine's cubic is 1e-9.
    CHECK(l.pose(1).angle == Approx(1e-4 * std::exp(-rate * 5.0 * period)).epsilon(1e-6));
}

TEST_CASE("linear drag on a rod is a viscous hinge, quadratic drag decays as 1/t", "[replay][free]") {
    effects::BodiesModel drag, hingeOnly;
    drag.airLinear = 2e-3;
    hingeOnly.bearingViscosity = 2e-3 * std::pow(kLength, 3) / 3.0; // integral of c s^2 over the rod
    Multibody a(pendulum(1.0), drag), b(pendulum(1.0), hingeOnly);
    play(a, 3.0);
    play(b, 3.0);
    CHECK(a.pose(1).angle == Approx(b.pose(1).angle).epsilon(1e-6));

    effects::BodiesModel square;
    const double beta = 0.05; // angle'' + w0^2 angle = - beta |spin| spin
    square.airQuadratic = beta * kInertia * 4.0 / std::pow(kLength, 4);
    constexpr double kStart = 0.05;
    Multibody l(pendulum(kStart), square);
    const std::vector<double> all = turns(l, 40, 60.0);
    REQUIRE(all.size() == 40);
    // Averaging: 1/A grows by 8 beta / 3 a period; next orders are beta A and A^2 / 16 relative, some 1e-3.
    CHECK(1.0 / std::abs(all[39]) == Approx(1.0 / kStart + 20.0 * 8.0 * beta / 3.0).epsilon(3e-3));
}

TEST_CASE("drag acts on the leading side only and integrates over a circle", "[replay][free]") {
    step::RigidWorldDefinition w;
    w.gravity = Vec2::Zero();
    step::BodyDefinition d;
    d.name = "disc";
    d.type = step::BodyType::Dynamic;
    d.linearVelocity = {2.0, 0.0};
    step::FixtureDefinition f;
    f.shape = step::ShapeKind::Circle;
    f.radius = 0.03;
    f.density = 5.0;
    d.fixtures = {f};
    w.bodies = {d};
    effects::BodiesModel extra;
    extra.airQuadratic = 0.4;
    Multibody l(w, extra);
    play(l, 1.0);
    const double mass = 5.0 * M_PI * 0.03 * 0.03;
    // Normal pressure q v^2 cos^2 over the front half: F = q v^2 r times the integral of cos^3 = 4/3; 1/v grows
    // linearly.
    const double k = 0.4 * 0.03 * 4.0 / 3.0 / mass;
    CHECK(1.0 / l.pose(0).velocity.x() == Approx(0.5 + k).epsilon(1e-3)); // 64 edges for the circle
    CHECK(l.energy() + l.airLoss() == Approx(0.5 * mass * 4.0).epsilon(1e-9));
}

TEST_CASE("a double pendulum swings in its normal modes", "[replay][free]") {
    for (const double sign : {-1.0, 1.0}) {
        const double lambda = 3.0 * (1.0 + sign * 2.0 / std::sqrt(7.0)); // w^2 L / g of two equal rods
        const double ratio = 0.5 * lambda / (0.5 - lambda / 3.0);
        constexpr double kSmall = 1e-4;
        Multibody l(two(kSmall, ratio * kSmall), {});
        REQUIRE(l.failure().empty());
        play(l, 2.0 * M_PI / std::sqrt(lambda * kGravity / kLength), 1e-3);
        CHECK(l.pose(1).angle == Approx(kSmall).epsilon(1e-6));
        CHECK(l.pose(2).angle == Approx(ratio * kSmall).epsilon(1e-6));
    }
}

TEST_CASE("energy is balanced with all effects, and joints stay closed", "[replay][free]") {
    effects::BodiesModel extra;
    extra.bearingTorque = 1e-4;
    extra.bearingArm = 2e-4;
    extra.bearingViscosity = 1e-6;
    extra.airLinear = 1e-3;
    extra.airQuadratic = 1e-2;
    Multibody l(two(2.0, 1.0), extra);
    const double start = l.energy();
    double lost = 0.0;
    for (int i = 0; i < 4000 && l.time() < 4.0; ++i) {
        l.advance(1e-3);
        CHECK(l.jointLoss() + l.airLoss() >= lost); // losses never decrease
        lost = l.jointLoss() + l.airLoss();
        REQUIRE(l.jointGap() < 1e-12);
    }
    CHECK(lost > 0.2 * (start + 2.0 * kWeight)); // the losses are substantial
    // A step in which a joint starts keeps its old torque to the end: first order in one step of a thousand.
    CHECK(l.energy() + lost == Approx(start).margin(1e-6 * kWeight));
}

TEST_CASE("load-dependent friction follows the reaction", "[replay][free]") {
    // A pendulum at rest held by hinge friction: R = m g, so the arm holds up to asin(arm / d).
    effects::BodiesModel extra;
    extra.bearingArm = 0.1 * 0.5 * kLength;
    Multibody holds(pendulum(std::asin(0.099)), extra), slips(pendulum(std::asin(0.101)), extra);
    play(holds, 1.0);
    play(slips, 1.0);
    CHECK(holds.pose(1).angle == Approx(std::asin(0.099)).epsilon(1e-12));
    CHECK(slips.pose(1).angle < std::asin(0.101) - 1e-6);
}

TEST_CASE("unsupported features of a free scene are reported", "[replay][free]") {
    step::RigidWorldDefinition w = pendulum(1.0);
    w.joints[0].enableLimit = true;
    CHECK(Multibody(w, {}).failure().find("limits") != std::string::npos);
    w = pendulum(1.0);
    w.joints[0].enableMotor = true;
    w.joints[0].maxMotorForce = 1.0;
    CHECK(Multibody(w, {}).failure().find("no motors") != std::string::npos);
    for (const step::JointKind kind :
         {step::JointKind::Distance, step::JointKind::Weld, step::JointKind::Wheel, step::JointKind::Gear}) {
        w = pendulum(1.0);
        w.joints[0].kind = kind;
        w.joints[0].frequency = 3.0;
        const bool taken = kind == step::JointKind::Distance || kind == step::JointKind::Weld;
        CHECK_THAT(Multibody(w, {}).failure(), Catch::Contains(taken ? "\"frequency\"" : "no joints of this type") &&
                                                   !Catch::Contains("limits") && !Catch::Contains("motors"));
    }
    w = pendulum(1.0);
    w.joints[0].anchorA = {0.01, 0.0};
    CHECK(Multibody(w, {}).failure().find("10") != std::string::npos); // mm apart
    w = pendulum(1.0);
    w.bodies[1].massData->mass = 0.0;
    CHECK(Multibody(w, {}).failure().find("no mass") != std::string::npos);
    w = pendulum(1.0);
    w.bodies[1].type = step::BodyType::Static;
    CHECK(Multibody(w, {}).failure().find("no body") != std::string::npos);
}
