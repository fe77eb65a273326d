#include "plugin/bench/bench_frames_scenes.h"

#include "bridge/box2d/lab_world.h"
#include "supercircle/step/rigid_definition.h"

#include <cmath>

namespace supercircle::cli {

namespace {

using step::BodyDefinition;
using step::BodyType;
using step::FixtureDefinition;
using step::RigidWorldDefinition;
using step::Vec2;

BodyDefinition boxAt(BodyType type, const Vec2& middle, const Vec2& half, double density = 1.0) {
    BodyDefinition body;
    body.type = type;
    body.position = middle;
    FixtureDefinition f;
    f.vertices = {{-half.x(), -half.y()}, {half.x(), -half.y()}, {half.x(), half.y()}, {-half.x(), half.y()}};
    f.density = density;
    f.friction = 0.35;
    body.fixtures.push_back(f);
    return body;
}

BodyDefinition floorBody() {
    return boxAt(BodyType::Static, {0.0, -0.5}, {50.0, 0.5});
}

FrameLevel levelOf(const RigidWorldDefinition& world) {
    FrameLevel level;
    std::string error;
    level.host = bridge::makeWorld(world, error);
    level.shells = std::make_unique<Shells>(level.host);
    level.shells->set_quality(Quality::Game).or_fail();
    return level;
}

/// A shell whose circle has its centre at (x, y); its opening looks up at angle 0.
ShellHandle put(FrameLevel& level, double x, double y, double angle = 0.0, double radius = 1.0, double mass = 2.0,
                double phiBar = 0.75) {
    ShellDef d = scaled_shell(radius, mass, phiBar);
    d.position = {x + radius * std::sin(angle), y - radius * std::cos(angle)};
    d.angle = angle;
    return level.shells->create(d).value();
}

/// A plate comes down on a shell that lies on the floor, and goes on.
FrameLevel press(double speed) {
    RigidWorldDefinition w;
    w.bodies = {floorBody(), boxAt(BodyType::Kinematic, {0.0, 1.2 + 1.0 * speed}, {5.0, 0.2})};
    w.bodies[1].linearVelocity = {0.0, -speed};
    FrameLevel level = levelOf(w);
    put(level, 0.0, 0.55, 0.0, 0.5, 1.0);
    return level;
}

/// A plate comes down on ten nested shells.
FrameLevel piston() {
    RigidWorldDefinition w;
    w.bodies = {floorBody(), boxAt(BodyType::Kinematic, {0.0, 4.0}, {5.0, 0.2})};
    w.bodies[1].linearVelocity = {0.0, -1.0};
    FrameLevel level = levelOf(w);
    for (int i = 0; i < 10; ++i)
        put(level, 0.0, 1.05 + 0.12 * i, 0.0, 1.0, 2.0, 0.4);
    return level;
}

/// A blow of an impulse (N s) on the middle of a dome.
FrameLevel blow(double impulse) {
    RigidWorldDefinition w;
    w.bodies = {floorBody()};
    FrameLevel level = levelOf(w);
    const ShellHandle shell = put(level, 0.0, 1.0, M_PI);
    level.shells->apply_impulse(shell, 0.5, {0.0, -impulse}).or_fail();
    return level;
}

FrameLevel fastWall() {
    RigidWorldDefinition w;
    w.bodies = {floorBody(), boxAt(BodyType::Kinematic, {-6.0, 2.0}, {0.5, 2.0})};
    w.bodies[1].linearVelocity = {30.0, 0.0};
    FrameLevel level = levelOf(w);
    for (int i = 0; i < 3; ++i)
        put(level, 2.5 * i, 1.05);
    return level;
}

/// Two shells made across each other; a car lands on a third one beside them.
FrameLevel strangers() {
    RigidWorldDefinition w;
    w.bodies = {floorBody(), boxAt(BodyType::Dynamic, {6.0, 4.5}, {1.0, 0.2}, 20.0)};
    for (const double x : {-0.7, 0.7}) {
        BodyDefinition wheel;
        wheel.type = BodyType::Dynamic;
        wheel.position = {6.0 + x, 4.2};
        FixtureDefinition disc;
        disc.shape = step::ShapeKind::Circle;
        disc.radius = 0.3;
        disc.density = 10.0;
        disc.friction = 0.9;
        wheel.fixtures.push_back(disc);
        w.bodies.push_back(wheel);
        step::JointDefinition axle;
        axle.bodyA = 1;
        axle.bodyB = static_cast<std::int32_t>(w.bodies.size()) - 1;
        axle.anchorA = {x, -0.3};
        w.joints.push_back(axle);
    }
    FrameLevel level = levelOf(w);
    put(level, 6.0, 1.05);
    put(level, 0.0, 2.0);
    put(level, 0.9, 2.3, 0.5 * M_PI);
    return level;
}

FrameLevel clampIntoFloor() {
    RigidWorldDefinition w;
    w.bodies = {floorBody()};
    FrameLevel level = levelOf(w);
    const ShellHandle shell = put(level, 0.0, 1.0, M_PI);
    const HoldHandle hold = level.shells->create_clamp(shell, 0.5).value();
    level.before = [shells = level.shells.get(), hold](int frame) {
        TargetDef to;
        to.position = {0.0, 2.0 - 7.0 * std::min(1.0, (frame + 1) / 60.0)};
        to.angle = M_PI;
        (void)shells->set_target(hold, to); // fails where the hold is gone
    };
    return level;
}

FrameLevel ribbon() {
    RigidWorldDefinition w;
    w.bodies = {floorBody()};
    FrameLevel level = levelOf(w);
    for (int i = 0; i < 8; ++i)
        put(level, 2.3 * (i % 4), 1.1 + 2.4 * (i / 4));
    ShellDef thin = scaled_shell(1.0, 2.0);
    thin.radius = INFINITY;
    thin.length = 4.0;
    thin.thickness = 0.001;
    thin.density = 1000.0;
    thin.young_modulus = 1e8;
    thin.elements = 31;
    thin.position = {3.0, 5.5};
    level.shells->create(thin).or_fail();
    return level;
}

RigidWorldDefinition boxOf(double width) {
    RigidWorldDefinition w;
    w.bodies = {floorBody(), boxAt(BodyType::Static, {-0.5 * width - 0.5, 40.0}, {0.5, 40.0}),
                boxAt(BodyType::Static, {0.5 * width + 0.5, 40.0}, {0.5, 40.0})};
    return w;
}

FrameLevel rain(int columns, int rows) {
    FrameLevel level = levelOf(boxOf(2.2 * columns));
    for (int i = 0; i < columns * rows; ++i)
        put(level, 2.2 * (i % columns + 0.5 - 0.5 * columns), 1.5 + 2.2 * (i / columns), 0.3 * (i % 20));
    return level;
}

FrameLevel crates() {
    RigidWorldDefinition w = boxOf(22.0);
    for (int i = 0; i < 300; ++i)
        w.bodies.push_back(boxAt(
            BodyType::Dynamic, {-10.5 + 0.7 * (i % 30) + 0.05 * (i / 30 % 2), 5.0 + 0.7 * (i / 30)}, {0.3, 0.3}, 3.0));
    FrameLevel level = levelOf(w);
    for (int i = 0; i < 20; ++i)
        put(level, 2.2 * (i % 10 - 4.5), 1.1 + 2.2 * (i / 10));
    return level;
}

} // namespace

std::vector<FrameScene> frameScenes() {
    const double frame = 1.0 / 60.0;
    return {
        {"press_0.5", 240, frame, [] { return press(0.5); }},
        {"press_2", 120, frame, [] { return press(2.0); }},
        {"piston", 240, frame, piston},
        {"blow_500", 60, frame, [] { return blow(500.0); }},
        {"blow_700", 60, frame, [] { return blow(700.0); }},
        {"wall_30", 60, frame, fastWall},
        {"strangers", 120, frame, strangers},
        {"clamp", 90, frame, clampIntoFloor},
        {"ribbon", 180, frame, ribbon},
        {"rain_200", 240, frame, [] { return rain(20, 10); }},
        {"crates_300", 180, frame, crates},
        {"second", 5, 1.0, [] { return rain(5, 4); }},
    };
}

} // namespace supercircle::cli
