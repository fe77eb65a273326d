// What is joined to a body alone goes with it when its user puts the body somewhere else; other gaps close, and frames
// of any length bring in nothing.

#include "tests/bridge/box2d/game_world.h"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

struct CarryLevel : GameWorld {
    CarryLevel(Quality quality, double scale)
        : GameWorld(quality, {.scale = scale, .gravity = 0.0F, .density = 100.0F}) {}
    b2Body* box(b2BodyType type, float x, float y) { return GameWorld::box(x, y, 0.2F, 0.1F, type); }
    void join(ShellHandle shell, double fraction, const b2Body* to, JointKind kind) {
        GameWorld::join(shell, fraction, *to, kind).or_fail();
    }
    void join(ShellHandle a, ShellHandle b) {
        JointDef j;
        j.kind = JointKind::Pin;
        j.shell = a;
        j.arc_fraction = 1.0;
        j.other = b;
        j.other_fraction = 0.0;
        shells.create_joint(j).or_fail();
    }
    void frame() {
        GameWorld::frame();
        REQUIRE(shells.events().quarantined.empty());
    }
    /// Of a shell's middle in the frame of the body, m and rad; x, y, angle.
    [[nodiscard]] std::array<double, 3> relative(ShellHandle shell, const b2Body* body) const {
        const ShellSection s = shells.section(shell, 0.5).value();
        const double a = static_cast<double>(body->GetAngle()), c = std::cos(a), n = std::sin(a);
        const double x = s.position.x - static_cast<double>(body->GetPosition().x) / static_cast<double>(L);
        const double y = s.position.y - static_cast<double>(body->GetPosition().y) / static_cast<double>(L);
        return {c * x + n * y, c * y - n * x, s.angle - a};
    }
};

} // namespace

TEST_CASE("a shell joined to a crate goes along when the crate is moved", "[box2d][carry]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    const b2BodyType type = GENERATE(b2_dynamicBody, b2_staticBody);
    const double way = GENERATE(1e-4, 1e-3, 0.01, 0.1, 1.0, 10.0, 100.0);
    const double turn = GENERATE(0.0, 1.0);
    const bool moving = GENERATE(false, true);
    if (type == b2_staticBody && (way < 1.0 || moving))
        return; // shorter ways of bodies without mass push and are no jumps
    CAPTURE(static_cast<int>(quality), scale, static_cast<int>(type), way, turn, moving);
    CarryLevel level(quality, scale);
    b2Body* crate = level.box(type, 0.0F, 0.0F);
    const ShellHandle shell = level.strip(0.0, 0.12), second = level.strip(0.6, 0.12);
    level.join(shell, 0.5, crate, JointKind::Weld);
    level.join(shell, second); // the far one follows as well
    if (moving) {
        crate->SetLinearVelocity({0.5F * level.L, 0.2F * level.L});
        level.shells.set_velocity(shell, {0.5, 0.2}).or_fail();
        level.shells.set_velocity(second, {0.5, 0.2}).or_fail();
    }
    for (int i = 0; i < 3; ++i)
        level.frame();
    const std::array<double, 3> a = level.relative(shell, crate), b = level.relative(second, crate);
    const double speed = level.speed();
    const EnergyBalance before = level.shells.energy_balance();
    crate->SetTransform(crate->GetPosition() + b2Vec2(level.L * static_cast<float>(way), 0.0F),
                        crate->GetAngle() + static_cast<float>(turn));
    for (int i = 0; i < 3; ++i) {
        level.frame();
        // Box2D stores 100 m with 8 um in single precision.
        const double margin = 1e-6 + 3e-7 * way;
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(level.relative(shell, crate)[k] == Approx(a[k]).margin(margin));
            CHECK(level.relative(second, crate)[k] == Approx(b[k]).margin(margin));
        }
        CHECK(level.speed() == Approx(speed).margin(1e-4 + 1e-4 * way));
    }
    const EnergyBalance after = level.shells.energy_balance();
    // A rounded place is off by 1e-7 of its distance, which is a speed over a frame.
    CHECK(after.injected - before.injected < 1e-9 + 1e-9 * way);
    CHECK(after.kinetic == Approx(before.kinetic).margin(1e-8 + 3e-6 * way));
    CHECK(std::abs(after.residual) < 1e-9);
}

TEST_CASE("a shell that something else holds too does not go along", "[box2d][carry]") {
    const int tie = GENERATE(0, 1, 2); // a hold, another body, a hold on its neighbour
    CarryLevel level(Quality::Game, 1.0);
    b2Body *crate = level.box(b2_dynamicBody, 0.0F, 0.0F), *other = level.box(b2_staticBody, 0.0F, 0.5F);
    const ShellHandle shell = level.strip(0.0, 0.12), second = level.strip(0.6, 0.12);
    level.join(shell, 0.5, crate, JointKind::Pin);
    level.join(shell, second);
    if (tie == 1)
        level.join(second, 0.5, other, JointKind::Tether);
    else
        level.shells.create_pin(tie == 0 ? shell : second, 1.0).or_fail();
    for (int i = 0; i < 3; ++i)
        level.frame();
    const double x = level.shells.section(shell, 0.5).value().position.x;
    crate->SetTransform({0.3F, 0.0F}, 0.0F);
    level.frame();
    CAPTURE(tie);
    CHECK(std::abs(level.shells.section(shell, 0.5).value().position.x - x) < 0.05); // the gap closes slowly
}

TEST_CASE("a joint made after the body was moved carries nobody", "[box2d][carry]") {
    const b2BodyType type = GENERATE(b2_dynamicBody, b2_staticBody);
    CarryLevel level(Quality::Game, 1.0);
    b2Body* crate = level.box(type, 0.0F, 0.0F);
    const ShellHandle shell = level.strip(3.0, 0.12), guest = level.strip(0.0, 0.3);
    level.frame();
    level.join(guest, 0.5, crate, JointKind::Tether); // so that the shells know the crate
    level.frame();
    crate->SetTransform({3.0F, 0.0F}, 0.0F);
    level.join(shell, 0.5, crate, JointKind::Weld);
    level.frame();
    CHECK(level.shells.section(shell, 0.5).value().position.x == Approx(3.0).margin(0.05)); // carried, it were at 6
}

TEST_CASE("a carried shell is not drawn on its way", "[box2d][carry]") {
    CarryLevel level(Quality::Game, 1.0);
    b2Body* crate = level.box(b2_dynamicBody, 0.0F, 0.0F);
    const ShellHandle shell = level.strip(0.0, 0.12);
    level.join(shell, 0.5, crate, JointKind::Weld); // before the first frame
    crate->SetTransform({50.0F, 0.0F}, 0.0F);
    level.frame();
    CHECK(level.shells.section(shell, 0.5).value().position.x == Approx(50.0).margin(1e-5));
    CHECK(level.shells.pose(shell, 0.0).value().start.x == level.shells.pose(shell).value().start.x);
}

TEST_CASE("a sleeping shell goes along with its body", "[box2d][carry]") {
    const JointKind kind = GENERATE(JointKind::Pin, JointKind::Weld, JointKind::Tether);
    const double way = GENERATE(2.0, 40.0);
    CAPTURE(static_cast<int>(kind), way);
    CarryLevel level(Quality::Game, 1.0);
    b2Body* block = level.box(b2_staticBody, 0.0F, 0.0F);
    const ShellHandle shell = level.strip(0.0, 0.12);
    level.join(shell, 0.5, block, kind);
    for (int i = 0; i < 3; ++i)
        level.frame();
    level.shells.sleep(shell).or_fail();
    level.frame();
    REQUIRE(level.shells.asleep(shell).value());
    const std::array<double, 3> before = level.relative(shell, block);
    block->SetTransform({static_cast<float>(way), 1.0F}, 0.5F);
    level.frame();
    for (std::size_t k = 0; k < 3; ++k)
        CHECK(level.relative(shell, block)[k] == Approx(before[k]).margin(1e-6 + 3e-7 * way));
}

namespace {

enum class End { World, Body, Shell };

/// A bumper whose lower tip is joined to something, in thirty frames of 1e-7 to 1 s.
void playFramesOfAnyLength(Quality quality, double units, JointKind kind, End end, unsigned seed) {
    CAPTURE(static_cast<int>(quality), units, static_cast<int>(kind), static_cast<int>(end), seed);
    GameWorld g(quality, {.scale = units, .density = 20.0F, .friction = 0.6F});
    // Box2D multiplies the impulses of its last step by the ratio of the steps, up to 1e7.
    g.world.SetWarmStarting(false);
    g.floor();
    b2Body* crate = g.box(0.0F, 0.5F, 1.4F, 0.2F, b2_dynamicBody);
    JointDef j;
    j.kind = kind;
    j.shell = g.bumper({1.77, 1.5});
    j.arc_fraction = 0.0;
    j.point = {1.42, kind == JointKind::Tether ? 2.0 : 1.15};
    if (end == End::Body) {
        j.body = g.port.body_id(*crate);
        j.point = {1.3, 0.6};
    } else if (end == End::Shell) {
        j.other = g.strip(0.87, 1.15);
        j.other_fraction = kind == JointKind::Tether ? 0.5 : 1.0;
    }
    if (end != End::World || kind == JointKind::Tether)
        REQUIRE(g.shells.create_joint(j));
    else if (kind == JointKind::Weld) // holds tie a shell to the world
        REQUIRE(g.shells.create_clamp(j.shell, 0.0));
    else
        REQUIRE(g.shells.create_pin(j.shell, 0.0));
    std::mt19937 random(seed);
    for (int i = 0; i < 30; ++i) {
        const double dt = std::pow(10.0, -7.0 * static_cast<double>(random()) / 4294967295.0);
        CAPTURE(i, dt);
        g.frame(dt); // no frame may raise the alarm
        CHECK(g.shells.events().quarantined.empty());
    }
}

/// Every kind, with the seeds that follow `seed`, or only with some that once raised the alarm.
void playAllFramesOfAnyLength(unsigned seed, const std::vector<unsigned>& only = {}) {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double units : {0.1, 1.0, 10.0, 50.0, 100.0})
            for (const JointKind kind : {JointKind::Pin, JointKind::Weld, JointKind::Tether})
                for (const End end : {End::World, End::Body, End::Shell}) {
                    ++seed;
                    if (only.empty() || std::find(only.begin(), only.end(), seed) != only.end())
                        playFramesOfAnyLength(quality, units, kind, end, seed);
                }
}

} // namespace

TEST_CASE("frames of any length in any order bring in nothing, whatever is joined", "[box2d][carry][slow]") {
    playAllFramesOfAnyLength(0);
}

TEST_CASE("frames of any length bring in nothing where ropes, joints and contacts contradict each other",
          "[box2d][carry]") {
    // 413: a body's way to its original during a blow; 446: a weld that stalled in steps of 1 us; 335, 1865: a crate
    // that was carried into the floor.
    for (const unsigned round : {0U, 2U, 3U, 4U, 20U})
        playAllFramesOfAnyLength(90 * round, {8, 27, 44, 56, 59, 77, 269, 335, 413, 446, 1865});
}

TEST_CASE("a falling crate with a shell does not pass a floor, however long a frame is", "[box2d][carry]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double units = GENERATE(1.0, 10.0, 50.0); // 2 units a step are 2 m, 0.2 m and 0.04 m
    const double dt = GENERATE(1.0 / 60.0, 0.1, 0.45);
    const int tie = GENERATE(0, 1, 2); // pinned beside it, welded on top of it, lying on it
    const b2BodyType type = GENERATE(b2_staticBody, b2_kinematicBody);
    CAPTURE(static_cast<int>(quality), units, dt, tie, static_cast<int>(type));
    GameWorld g(quality, {.scale = units, .density = 20.0F, .friction = 0.6F});
    g.box(0.0F, -0.05F, 40.0F, 0.05F, type); // 0.1 m thick
    b2Body* crate = g.box(0.0F, 0.5F, 0.6F, 0.2F, b2_dynamicBody);
    if (tie == 0)
        g.join(g.bumper({0.97, 0.75}), 0.0, *crate, JointKind::Pin).or_fail();
    else if (const ShellHandle shell = g.strip(0.0, 0.71); tie == 1)
        g.join(shell, 0.5, *crate, JointKind::Weld).or_fail();
    crate->SetLinearVelocity({0.0F, -4.0F * g.L});
    for (int i = 0; i < std::max(30, static_cast<int>(4.0 / dt)); ++i) {
        g.frame(dt);
        CHECK(crate->GetPosition().y / g.L > 0.0F); // 0.2 where it lies on the floor
    }
    if (dt < 0.4) // in longer steps Box2D's limit lets the crate fall for a minute
        CHECK(std::abs(crate->GetLinearVelocity().y / g.L) < 0.05F);
}

TEST_CASE("a gap of up to ten thicknesses that nothing carries is closed within a second", "[box2d][carry]") {
    // A bumper between two heavy crates, of which one is put elsewhere.
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double units = GENERATE(0.1, 1.0, 50.0, 100.0);
    const JointKind kind = GENERATE(JointKind::Pin, JointKind::Weld, JointKind::Tether);
    const double thicknesses = GENERATE(0.1, 1.0, 10.0);
    CAPTURE(static_cast<int>(quality), units, static_cast<int>(kind), thicknesses);
    CarryLevel level(quality, units);
    level.material.density *= 100.0F;
    const ShellHandle shell = level.bumper({0.35, 0.0}); // its tips at x = 0, y = -0.35 and 0.35
    const double h = level.shells.world().rods[0].model.definition().thickness;
    b2Body* low = level.box(b2_dynamicBody, 0.0F, -0.6F);
    b2Body* high = level.box(b2_dynamicBody, 0.0F, 0.6F);
    level.join(shell, 0.0, low, kind);
    level.join(shell, 1.0, high, kind);
    for (int i = 0; i < 10; ++i)
        level.frame();
    const Point tip = level.shells.section(shell, 1.0).value().position;
    const double apart = 0.25; // of a tether's ends
    high->SetTransform(high->GetPosition() + b2Vec2(0.0F, static_cast<float>(thicknesses * h) * level.L), 0.0F);
    for (int i = 0; i < 60; ++i)
        level.frame();
    const ShellSection now = level.shells.section(shell, 1.0).value();
    const double x = static_cast<double>(high->GetPosition().x / level.L), turn = static_cast<double>(high->GetAngle());
    const double y = static_cast<double>(high->GetPosition().y / level.L);
    if (kind == JointKind::Tether) {
        CHECK(std::hypot(now.position.x - x, now.position.y - y) < apart + 0.02 * h);
    } else { // the crate's own point, where the tip was
        const double dx = tip.x, dy = tip.y - 0.6;
        const double c = std::cos(turn), n = std::sin(turn);
        CHECK(std::hypot(now.position.x - (x + c * dx - n * dy), now.position.y - (y + n * dx + c * dy)) < 0.02 * h);
    }
}

TEST_CASE("a joint lifts a crate that was moved away from it", "[box2d][carry]") {
    // A strip clamped at one end, at whose other end a crate of 48 kg hangs, ten thicknesses too low.
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double units = GENERATE(1.0, 50.0);
    const JointKind kind = GENERATE(JointKind::Pin, JointKind::Tether);
    CAPTURE(static_cast<int>(quality), units, static_cast<int>(kind));
    GameWorld g(quality, {.scale = units, .density = 100.0F});
    const ShellHandle shell = g.strip(0.3, 0.0);
    g.shells.create_clamp(shell, 0.0).or_fail();
    b2Body* crate = g.box(0.3F, -0.6F, 0.6F, 0.2F, b2_dynamicBody);
    g.join(shell, 0.5, *crate, kind).or_fail();
    for (int i = 0; i < 60; ++i)
        g.frame();
    const double h = g.shells.world().rods[0].model.definition().thickness;
    const double before = static_cast<double>(crate->GetPosition().y / g.L);
    crate->SetTransform(crate->GetPosition() - b2Vec2(0.0F, static_cast<float>(10.0 * h) * g.L), 0.0F);
    for (int i = 0; i < 60; ++i)
        g.frame();
    CHECK(static_cast<double>(crate->GetPosition().y / g.L) == Approx(before).margin(0.3 * h)); // it swings by that
}

TEST_CASE("a rope that is far too short stops no game, whatever its frames may take", "[box2d][carry]") {
    // It became too short by its user's hand, and a strip lies between its ends. A frame without a step ends after two
    // trials, so that gaps which are judged must not take a third.
    const std::uint64_t budget = GENERATE(1, 20, 100, 500);
    const double apart = GENERATE(0.1, 1.0, 5.0);
    CAPTURE(budget, apart);
    GameWorld g(Quality::Game, {.density = 20.0F});
    g.floor();
    b2Body* crate = g.box(0.0F, 0.5F, 1.4F, 0.2F, b2_dynamicBody);
    JointDef j;
    j.kind = JointKind::Tether;
    j.shell = g.bumper({1.77, 1.5});
    j.body = g.port.body_id(*crate);
    j.point = {1.3, 0.6};
    g.shells.create_joint(j).or_fail();
    g.shells.create_pin(j.shell, 1.0).or_fail(); // else the shell goes along with the crate
    g.frame();
    g.shells.set_frame_budget(budget).or_fail();
    crate->SetTransform(crate->GetPosition() - b2Vec2(static_cast<float>(apart), 0.0F), 0.5F);
    int standing = 0;
    for (int i = 0; i < 120; ++i) {
        standing = g.frame().advanced > 0.0 ? 0 : standing + 1;
        REQUIRE(standing < 20);
    }
    if (apart >= 1.0)
        CHECK(g.shells.world().counters.rejectedFor[static_cast<std::size_t>(step::Reason::GapEnergy)] > 0);
}
