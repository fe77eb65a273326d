#pragma once
// A Box2D world with shells, stepped as by a game. Lengths are in SI; Box2D's are L times larger.

#include "bridge/box2d/include/supercircle/box2d.hpp"
#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/world.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

namespace supercircle::bridge_test {

constexpr double kFrame = 1.0 / 60.0; ///< s

struct GameSettings {
    double scale = 1.0;     ///< Box2D units a metre
    float gravity = -9.81F; ///< m/s^2
    float density = 0.0F;   ///< of all bodies, kg/m^2
    float friction = 0.2F;  ///< of all bodies; Box2D's default
};

struct GameWorld {
    explicit GameWorld(Quality quality, const GameSettings& s = {})
        : L(static_cast<float>(s.scale)), world({0.0F, L * s.gravity}), port(bridge::attach(world, {s.scale})),
          shells(port) {
        material.density = s.density / (L * L);
        material.friction = s.friction;
        shells.set_quality(quality).or_fail();
    }

    b2Body* body(b2BodyType type, float x, float y) {
        b2BodyDef d;
        d.type = type;
        d.position.Set(L * x, L * y);
        return world.CreateBody(&d);
    }
    /// `shape` is in Box2D's units.
    b2Fixture* fixture(b2Body* on, const b2Shape& shape) const {
        b2FixtureDef f = material;
        f.shape = &shape;
        return on->CreateFixture(&f);
    }
    b2Body* box(float x, float y, float halfX, float halfY, b2BodyType type = b2_staticBody) {
        b2PolygonShape s;
        s.SetAsBox(L * halfX, L * halfY);
        return fixture(body(type, x, y), s)->GetBody();
    }
    b2Body* floor() { return box(0.0F, -0.5F, 40.0F, 0.5F); }

    /// Half a circle, its middle at `at`; it opens downwards unless `angle` is given.
    static ShellDef dome(double radius, Point at, double angle = M_PI) {
        ShellDef d = scaled_shell(radius, 2.0 * radius, 0.5);
        d.position = at;
        d.angle = angle;
        return d;
    }
    /// A stiff half circle of ten arcs, 1.1 m long.
    ShellHandle bumper(Point at, double angle = M_PI / 2.0) {
        ShellDef d = scaled_shell(0.35, 0.4, 0.5, 60.0);
        d.elements = 10;
        d.position = at;
        d.angle = angle;
        return shells.create(d).value();
    }
    /// The same, straight and level.
    ShellHandle strip(double x, double y) {
        ShellDef d = scaled_shell(0.35, 0.4, 0.5, 60.0);
        d.elements = 10;
        d.natural_curvature.assign(10, 0.0);
        d.position = {x, y};
        return shells.create(d).value();
    }
    /// A tether is tied to the body's origin.
    Result<JointHandle> join(ShellHandle shell, double fraction, const b2Body& to, JointKind kind,
                             double length = 0.0) {
        JointDef j;
        j.kind = kind;
        j.shell = shell;
        j.arc_fraction = fraction;
        j.body = port.body_id(to);
        j.point = {static_cast<double>(to.GetPosition().x / L), static_cast<double>(to.GetPosition().y / L)};
        j.length = length;
        return shells.create_joint(j);
    }

    FrameReport begin(double dt = kFrame) {
        const FrameReport r = shells.pre_step(dt);
        INFO(r.failure << r.why);
        if (r.unconverged == 0)
            CHECK(r.energy_gained == 0.0);
        REQUIRE(r.failure.empty());
        return r;
    }
    Status end(const FrameReport& r) {
        world.Step(static_cast<float>(r.advanced), 8, 3);
        return shells.post_step();
    }
    FrameReport frame(double dt = kFrame) {
        const FrameReport r = begin(dt);
        end(r).or_fail();
        return r;
    }
    /// Of the fastest shell, m/s.
    [[nodiscard]] double speed() const {
        double v = 0.0;
        for (const step::Rod& r : shells.world().rods)
            v = std::max(v, r.speed);
        return v;
    }

    float L; ///< units a metre
    b2FixtureDef material;
    b2World world;
    bridge::Attachment port;
    Shells shells;
};

} // namespace supercircle::bridge_test
