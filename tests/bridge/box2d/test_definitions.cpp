#include "definitions.h"

#include "bridge/box2d/lab_world.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace supercircle;
using namespace supercircle::step;
using namespace supercircle::bridge_test;

TEST_CASE("invalid definitions are refused with a message", "[bridge]") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto polygon = [](std::vector<Vec2> v) {
        FixtureDefinition f;
        f.vertices = std::move(v);
        return worldWith(body(BodyType::Dynamic, f, "culprit"));
    };
    const auto mentions = [](const std::string& text, const std::string& part) {
        INFO(text);
        CHECK(text.find(part) != std::string::npos);
    };
    mentions(errorOf(polygon({{0, 0}, {1, 0}})), "3 to 8");
    mentions(errorOf(polygon({{0, 0}, {1, 0}})), "culprit");
    std::vector<Vec2> nine;
    for (int i = 0; i < 9; ++i)
        nine.emplace_back(std::cos(0.7 * i), std::sin(0.7 * i));
    mentions(errorOf(polygon(nine)), "3 to 8");
    mentions(errorOf(polygon({{0, 0}, {1, 0}, {0.1, 0.1}, {0, 1}})), "convex");
    std::vector<Vec2> star;
    for (int i = 0; i < 5; ++i)
        star.emplace_back(std::cos(i * 0.8 * M_PI), std::sin(i * 0.8 * M_PI));
    mentions(errorOf(polygon(star)), "winds");
    mentions(errorOf(polygon({{0, 0}, {1, 0}, {2, 1e-12}})), "area");
    mentions(errorOf(polygon({{0, 0}, {1e-5, 0}, {1, 1}})), "lengthScale");
    mentions(errorOf(polygon({{0, 0}, {nan, 0}, {1, 1}})), "vertex");
    mentions(errorOf(polygon({{0, 0}, {1e9, 0}, {1, 1}})), "vertex");
    mentions(errorOf(polygon({{100, 100}, {100.01, 100}, {100, 100.01}})), "origin");

    const RigidWorldDefinition good = worldWith(body(BodyType::Dynamic, box(0.1, 0.1), "b"));
    const auto changed = [&](auto change) {
        RigidWorldDefinition d = good;
        change(d);
        return errorOf(d);
    };
    mentions(changed([&](auto& d) { d.lengthScale = nan; }), "lengthScale");
    mentions(changed([&](auto& d) { d.lengthScale = 0.0; }), "lengthScale");
    mentions(changed([&](auto& d) { d.gravity.x() = nan; }), "gravity");
    mentions(changed([&](auto& d) { d.bodies[0].position.y() = nan; }), "position");
    mentions(changed([&](auto& d) { d.bodies[0].position.y() = 1e6; }), "position");
    mentions(changed([&](auto& d) { d.bodies[0].linearVelocity.y() = INFINITY; }), "linearVelocity");
    mentions(changed([&](auto& d) { d.bodies[0].angularDamping = -1.0; }), "damping");
    mentions(changed([&](auto& d) { d.bodies[0].fixtures[0].density = -1.0; }), "density");
    mentions(changed([&](auto& d) { d.bodies[0].fixtures[0].density = 1e-40; }), "small");
    mentions(changed([&](auto& d) { d.bodies[0].fixtures[0].friction = nan; }), "friction");
    mentions(changed([&](auto& d) {
                 d.bodies[0].fixtures[0].shape = ShapeKind::Circle;
                 d.bodies[0].fixtures[0].radius = 0.0;
             }),
             "radius");
    mentions(changed([&](auto& d) {
                 d.bodies[0].fixtures[0].shape = ShapeKind::Chain;
                 d.bodies[0].fixtures[0].vertices = {{0, 0}, {0, 1e-6}};
             }),
             "shorter");
    mentions(changed([&](auto& d) {
                 d.bodies[0].fixtures[0].shape = ShapeKind::Loop;
                 d.bodies[0].fixtures[0].vertices = {{0, 0}, {0, 1}};
             }),
             "loop");
    JointDefinition j;
    j.name = "hinge";
    j.bodyA = 0;
    j.bodyB = 1;
    mentions(changed([&](auto& d) { d.joints = {j}; }), "out of range");
    j.bodyB = -1;
    mentions(changed([&](auto& d) { d.joints = {j}; }), "out of range");
    j.bodyB = 0;
    mentions(changed([&](auto& d) { d.joints = {j}; }), "hinge");
    const auto joined = [&](auto change) {
        RigidWorldDefinition d = good;
        d.bodies.push_back(good.bodies[0]);
        JointDefinition k;
        k.bodyA = 0;
        k.bodyB = 1;
        change(k);
        d.joints = {k};
        return errorOf(d);
    };
    mentions(joined([&](auto& k) { k.anchorA.x() = nan; }), "anchor");
    mentions(joined([&](auto& k) { k.motorSpeed = nan; }), "motorSpeed");
    mentions(joined([&](auto& k) { k.enableLimit = true, k.lowerLimit = 1.0; }), "lowerLimit");
    mentions(joined([&](auto& k) { k.kind = JointKind::Prismatic, k.localAxisA.setZero(); }), "localAxisA");
    mentions(joined([&](auto& k) { k.maxTorque = -1.0; }), "negative");
    CHECK_THROWS_AS(build(good)->step(nan), std::invalid_argument);
}

TEST_CASE("joints of every kind are created and work", "[bridge]") {
    const auto worldOf = [](const JointDefinition& j) {
        RigidWorldDefinition d;
        d.lengthScale = 52.1;
        BodyDefinition ground = body(BodyType::Static, box(0.01, 0.01), "ground");
        BodyDefinition bob = body(BodyType::Dynamic, box(0.01, 0.01), "bob");
        bob.position = Vec2(0.1, 0.0);
        d.bodies = {ground, bob};
        d.joints = {j};
        d.joints[0].bodyA = 0;
        d.joints[0].bodyB = 1;
        return d;
    };
    const auto fall = [](HostWorld& world) {
        for (int i = 0; i < 1000; ++i)
            world.step(1e-3);
        BodyState s;
        REQUIRE(world.state(2, s));
        return s;
    };
    JointDefinition j;
    j.anchorB = Vec2(-0.1, 0.0);
    for (const JointKind kind : {JointKind::Revolute, JointKind::Weld, JointKind::Prismatic, JointKind::Friction}) {
        JointDefinition k = j;
        k.kind = kind;
        k.maxMotorForce = 100.0; // the friction joint carries more than the bob's 3.9 N
        k.maxTorque = 100.0;
        auto world = build(worldOf(k));
        const BodyState s = fall(*world);
        INFO("kind " << static_cast<int>(kind));
        if (kind == JointKind::Revolute) // the pendulum keeps its length
            CHECK(s.centre.norm() == Approx(0.1).epsilon(1e-3));
        else // weld, slide along x and strong friction stay put
            CHECK((s.centre - Vec2(0.1, 0.0)).norm() < 1e-3);
    }
    JointDefinition rod;
    rod.kind = JointKind::Distance;
    rod.length = 0.1;
    CHECK(fall(*build(worldOf(rod))).centre.norm() == Approx(0.1).epsilon(1e-3));
    JointDefinition motor;
    motor.kind = JointKind::Motor;
    motor.anchorA = Vec2(0.1, 0.05);
    motor.maxMotorForce = 1000.0;
    motor.maxTorque = 1000.0;
    CHECK((fall(*build(worldOf(motor))).centre - Vec2(0.1, 0.05)).norm() < 1e-3);
    // A wheel hangs in its spring by g / omega^2 below rest (damped, so it has settled after a second).
    JointDefinition wheel;
    wheel.kind = JointKind::Wheel;
    wheel.anchorA = Vec2(0.1, 0.0);
    wheel.localAxisA = Vec2(0.0, 1.0);
    wheel.frequency = 5.0;
    wheel.dampingRatio = 0.7;
    const double omega = 2.0 * M_PI * 5.0;
    CHECK(fall(*build(worldOf(wheel))).centre.y() == Approx(-9.81 / (omega * omega)).epsilon(0.01));
    // A rope of R.U.B.E.: a distance joint with a largest length only.
    JointDefinition rope;
    rope.kind = JointKind::Distance;
    rope.enableLimit = true;
    rope.upperLimit = 0.15;
    CHECK(fall(*build(worldOf(rope))).centre.norm() == Approx(0.15).epsilon(1e-2));
    JointDefinition mouse;
    mouse.kind = JointKind::Mouse;
    mouse.anchorB = Vec2(0.1, 0.0);
    mouse.target = Vec2(0.15, 0.05);
    mouse.maxMotorForce = 1000.0;
    mouse.frequency = 5.0;
    mouse.dampingRatio = 0.7;
    CHECK((fall(*build(worldOf(mouse))).centre - Vec2(0.15, 0.05 - 9.81 / (omega * omega))).norm() < 1e-3);
}

TEST_CASE("pulleys and gears of a definition hold their sum in metres", "[bridge]") {
    RigidWorldDefinition d;
    d.lengthScale = 52.1;
    d.bodies = {body(BodyType::Static, box(0.01, 0.01), "ground"), body(BodyType::Dynamic, box(0.01, 0.01), "wheel"),
                body(BodyType::Dynamic, box(0.02, 0.01), "rack")};
    d.bodies[1].position = Vec2(-0.2, 0.0);
    d.bodies[2].position = Vec2(0.2, 0.0);
    JointDefinition pulley;
    pulley.kind = JointKind::Pulley;
    pulley.bodyA = 1;
    pulley.bodyB = 2;
    pulley.groundAnchorA = Vec2(-0.2, 0.2);
    pulley.groundAnchorB = Vec2(0.2, 0.2);
    pulley.lengthA = pulley.lengthB = 0.2;
    pulley.ratio = 1.0;
    RigidWorldDefinition hanging = d;
    hanging.joints = {pulley};
    auto world = build(hanging);
    BodyState wheel, rack;
    for (int i = 0; i < 200; ++i)
        world->step(1e-3);
    REQUIRE(world->state(2, wheel));
    REQUIRE(world->state(3, rack));
    CHECK(wheel.centre.y() != Approx(0.0).margin(1e-3)); // it moves
    CHECK(wheel.centre.y() + rack.centre.y() == Approx(0.0).margin(2e-3));

    // The rack falls and turns the wheel: angle + ratio * way stays.
    JointDefinition axle, rail, gear;
    axle.kind = JointKind::Revolute;
    axle.bodyA = 0;
    axle.bodyB = 1;
    axle.anchorA = Vec2(-0.2, 0.0);
    rail.kind = JointKind::Prismatic;
    rail.bodyA = 0;
    rail.bodyB = 2;
    rail.anchorA = Vec2(0.2, 0.0);
    rail.localAxisA = Vec2(0.0, 1.0);
    gear.kind = JointKind::Gear;
    gear.bodyA = 1;
    gear.bodyB = 2;
    gear.joint1 = 1;
    gear.joint2 = 2;
    gear.ratio = 5.0; // rad/m
    RigidWorldDefinition geared = d;
    geared.joints = {gear, axle, rail};
    world = build(geared);
    for (int i = 0; i < 200; ++i)
        world->step(1e-3);
    REQUIRE(world->state(2, wheel));
    REQUIRE(world->state(3, rack));
    CHECK(rack.centre.y() < -0.01);
    CHECK(wheel.angle == Approx(-5.0 * rack.centre.y()).epsilon(1e-2));
}
