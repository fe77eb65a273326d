// Shells in a Box2D world, as in a game.

#include "supercircle/step/world.h"
#include "tests/support/allocations.h"

#include <algorithm>
#include <box2d/box2d.h>
#include <catch2/catch.hpp>
#include <cmath>
#include <supercircle/box2d.hpp>
#include <supercircle/shells.hpp>

using namespace supercircle;

namespace {

constexpr double kFrame = 1.0 / 60.0; // s

struct Game {
    b2World world{b2Vec2(0.0F, -9.81F)};
    Shells shells{bridge::attach(world)};

    Game() {
        b2BodyDef def;
        b2Body* ground = world.CreateBody(&def);
        wall(*ground, 50.0F, 0.5F, {0.0F, -0.5F});
        wall(*ground, 0.5F, 20.0F, {-6.5F, 20.0F});
        wall(*ground, 0.5F, 20.0F, {6.5F, 20.0F});
        REQUIRE(shells.set_quality(Quality::Game));
    }
    static void wall(b2Body& body, float halfWidth, float halfHeight, const b2Vec2& centre) {
        b2PolygonShape box;
        box.SetAsBox(halfWidth, halfHeight, centre, 0.0F);
        body.CreateFixture(&box, 0.0F)->SetFriction(0.5F);
    }
    b2Body* crate(float x, float y, float half) {
        b2BodyDef def;
        def.type = b2_dynamicBody;
        def.position.Set(x, y);
        b2Body* body = world.CreateBody(&def);
        b2PolygonShape box;
        box.SetAsBox(half, half);
        body->CreateFixture(&box, 2.0F)->SetFriction(0.4F);
        return body;
    }
    /// A shell of radius 1 m whose circle has its centre at (x, y).
    ShellHandle shell(double x, double y, double angle) {
        ShellDef d = scaled_shell(1.0, 2.0, 0.6);
        d.position = {x + std::sin(angle), y - std::cos(angle)};
        d.angle = angle;
        const auto made = shells.create(d);
        REQUIRE(made);
        return *made;
    }
    FrameReport frame() {
        const FrameReport r = shells.pre_step(kFrame);
        world.Step(static_cast<float>(r.advanced), 8, 3);
        REQUIRE(shells.post_step());
        return r;
    }
};

} // namespace

TEST_CASE("a game with crates, joints and holds allocates no memory once it rests", "[player][game]") {
    if (!test::countsAllocations())
        return;
    Game g;
    for (int i = 0; i < 12; ++i)
        g.shell(3.2 * (i % 3 - 1), 1.6 + 2.4 * (i / 3), 2.3 * i);
    for (int i = 0; i < 4; ++i)
        g.crate(-3.0F + 2.0F * static_cast<float>(i), 13.0F, 0.35F);
    b2Body *a = g.crate(-5.2F, 0.4F, 0.3F), *b = g.crate(-4.4F, 0.4F, 0.3F);
    b2RevoluteJointDef joint;
    joint.Initialize(a, b, {-4.8F, 0.4F});
    g.world.CreateJoint(&joint);
    REQUIRE(g.shells.create_clamp(g.shell(-4.5, 18.0, M_PI), 0.5));
    REQUIRE(g.shells.create_pin(g.shell(4.5, 18.0, 0.0), 0.0));

    std::vector<std::uint64_t> resting;
    std::uint64_t settling = 0;
    for (int i = 0; i < 1200; ++i) {
        const std::uint64_t start = test::allocations();
        const FrameReport r = g.shells.pre_step(kFrame);
        const std::uint64_t middle = test::allocations();
        g.world.Step(static_cast<float>(r.advanced), 8, 3);
        const std::uint64_t again = test::allocations();
        REQUIRE(g.shells.post_step());
        const std::uint64_t taken = middle - start + test::allocations() - again;
        REQUIRE(r.failure.empty());
        if (i >= 1000)
            resting.push_back(taken);
        else if (i >= 300)
            settling += taken;
    }
    CHECK(g.shells.world().impulses.size() >= 12);
    // A contact that Box2D opens and closes again changes the order of the rows. Rows whose number of unknowns changes
    // are allocated anew: a dozen allocations in some frames. All other frames allocate nothing.
    std::sort(resting.begin(), resting.end());
    CHECK(resting[resting.size() / 2] == 0);
    CHECK(resting.back() <= 100); // an upper bound, not physics
    INFO("while it settles: " << static_cast<double>(settling) / 700.0 << " a frame");
    CHECK(settling < 700 * 60); // likewise
}

TEST_CASE("a body created inside a shell parts from it and quarantines none", "[player][game]") {
    Game g;
    const ShellHandle hit = g.shell(-3.0, 1.1, M_PI), other = g.shell(3.0, 1.1, M_PI);
    for (int i = 0; i < 60; ++i)
        REQUIRE(g.frame().failure.empty());
    const auto through = g.shells.section(hit, 0.5); // the top of the dome
    REQUIRE(through);
    g.crate(static_cast<float>(through->position.x), static_cast<float>(through->position.y), 0.6F);
    REQUIRE(g.shells.apply_impulse(other, 0.5, {1.0, 0.0}));
    std::size_t told = 0;
    for (int i = 0; i < 300; ++i) {
        const FrameReport r = g.frame();
        REQUIRE(r.failure.empty());
        REQUIRE(r.advanced == Approx(kFrame));
        CHECK(r.quarantined.empty());
        for (const OverlapEvent& e : g.shells.events().overlapping) {
            CHECK(e.a == hit);
            CHECK(e.b.null());
            CHECK(e.body != 0);
            ++told;
        }
    }
    CHECK(g.shells.time() == Approx(360 * kFrame));
    CHECK(told == 1);
    CHECK(g.shells.world().overlaps.empty());
}
