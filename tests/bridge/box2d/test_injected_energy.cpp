// Corrections of joints, holds, contacts and copies add no motion, and nothing fast passes unseen.

#include "tests/bridge/box2d/game_world.h"
#include "tests/support/share.h"

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

struct EnergyGame : GameWorld {
    explicit EnergyGame(Quality quality, float gravity = -9.81F, double scale = 1.0, float density = 20.0F)
        : GameWorld(quality, {.scale = scale, .gravity = gravity, .density = density, .friction = 0.6F}) {}
    void frame(double dt = kFrame) {
        GameWorld::frame(dt);
        CHECK(shells.events().quarantined.empty());
    }
};

} // namespace

TEST_CASE("a crate with a welded shell lands and stays", "[box2d][injected]") {
    // The body leaves the floor no faster than it came: corrections close at 20 thicknesses a second.
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double units : {1.0, 50.0})
            for (const int tips : {1, 2}) {
                EnergyGame g(quality, -9.81F, units);
                g.floor();
                b2Body* crate = g.box(0.0F, 1.8F, 0.5F, 0.5F, b2_dynamicBody);
                const ShellHandle shell = g.bumper({0.87, 1.8});
                for (int i = 0; i < tips; ++i)
                    REQUIRE(g.join(shell, static_cast<double>(i), *crate, JointKind::Weld));
                double highest = 0.0;
                bool landed = false;
                for (int i = 0; i < 90; ++i) {
                    g.frame();
                    const double y = static_cast<double>(crate->GetPosition().y) / units;
                    landed = landed || y < 0.53;
                    if (landed)
                        highest = std::max(highest, y - 0.5);
                }
                CHECK(landed);
                CHECK(highest < 0.05); // 174 m before the bound; Box2D's own skin is 0.01 m
            }
}

TEST_CASE("a short frame is no blow", "[box2d][injected]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const JointKind kind : {JointKind::Weld, JointKind::Pin})
            for (const double dt : {1e-3, 1e-5, 1e-7}) {
                EnergyGame g(quality, -9.81F, 1.0, 40.0F);
                g.floor();
                b2Body* crate = g.box(0.0F, 1.5F, 1.4F, 0.2F, b2_dynamicBody);
                REQUIRE(g.join(g.bumper({1.77, 1.5}), 0.0, *crate, kind));
                double fastest = 0.0;
                for (int i = 0; i < 45; ++i) {
                    g.frame(i == 30 ? dt : kFrame);
                    fastest = std::max(fastest, static_cast<double>(crate->GetLinearVelocity().Length()));
                }
                CHECK(fastest < 1.25 * std::sqrt(2.0 * 9.81 * 1.3)); // of the fall, and a quarter for Box2D's own
            }
}

namespace {

/// A ball against a clamped dome.
void passNothing(test::Share share) {
    // A clamped dome without gravity; judged by the body's poses from frame to frame.
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double hz : {30.0, 60.0})
            for (const double speed : {5.0, 20.0, 60.0, 110.0}) // Box2D stops at 2 m a step: 120 m/s at 60 Hz
                for (int phase = 0; phase < 5; ++phase) {
                    if (!share.next())
                        continue;
                    EnergyGame g(quality, 0.0F);
                    const ShellHandle dome = g.shells.create(EnergyGame::dome(1.0, {0.0, 1.0})).value();
                    REQUIRE(g.shells.create_clamp(dome, 0.0));
                    REQUIRE(g.shells.create_clamp(dome, 1.0));
                    b2BodyDef def;
                    def.type = b2_dynamicBody;
                    def.bullet = true;
                    const double way = std::min(speed / hz, 2.0);
                    def.position.Set(0.0F, static_cast<float>(2.0 + phase / 5.0 * way));
                    b2Body* ball = g.world.CreateBody(&def);
                    b2CircleShape circle;
                    circle.m_radius = 0.05F;
                    ball->CreateFixture(&circle, 10.0F);
                    ball->SetLinearVelocity({0.0F, static_cast<float>(-speed)});
                    bool touched = false;
                    for (double t = 0.0; t < 3.0 / std::min(speed, 2.0 * hz) + 0.1; t += 1.0 / hz) {
                        g.frame(1.0 / hz);
                        touched = touched || !g.shells.events().contact_begin.empty();
                    }
                    CHECK(touched);
                }
}

} // namespace

TEST_CASE("no body passes a shell unseen, at any speed and phase", "[box2d][injected]") {
    passNothing(test::Share(3));
}

TEST_CASE("no body passes a shell unseen, at every speed and phase", "[box2d][injected][slow]") {
    passNothing(test::Share(1));
}

TEST_CASE("a joint to a body that its user has moved closes without a blow", "[box2d][injected]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double way : {0.001, 0.007, 0.05}) {
            EnergyGame g(quality);
            g.floor();
            b2Body* crate = g.box(0.0F, 0.5F, 0.5F, 0.5F, b2_dynamicBody);
            REQUIRE(g.join(g.bumper({0.9, 0.5}), 0.0, *crate, JointKind::Weld));
            for (int i = 0; i < 30; ++i)
                g.frame();
            crate->SetTransform(crate->GetPosition() + b2Vec2(static_cast<float>(-way), 0.0F), crate->GetAngle());
            double fastest = 0.0;
            for (int i = 0; i < 60; ++i) {
                g.frame();
                fastest = std::max(fastest, static_cast<double>(crate->GetLinearVelocity().Length()));
            }
            CHECK(fastest < 0.5); // m/s; 20 h/s are 0.5
        }
}

TEST_CASE("a platform that is put forward every frame carries what stands on its way", "[box2d][injected]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory}) {
        EnergyGame g(quality);
        g.floor();
        b2Body* pusher = g.box(-2.0F, 0.5F, 0.5F, 0.5F, b2_kinematicBody);
        ShellDef d = EnergyGame::dome(0.5, {0.0, 0.52});
        d.mu = 0.1;
        const ShellHandle dome = g.shells.create(d).value();
        for (int i = 0; i < 180; ++i) { // 1 m/s by SetTransform, its velocity stays zero
            pusher->SetTransform({-2.0F + static_cast<float>(i) / 60.0F, 0.5F}, 0.0F);
            g.frame();
        }
        const auto state = g.shells.state(dome);
        REQUIRE(state);
        // It moved 3 m; its face is at 1.48 m, and the shell lies before it.
        CHECK(state->box.lower.x > 1.48 - 0.01);
        CHECK(state->box.lower.x < 1.48 + 0.6);
    }
}

TEST_CASE("a crate at rest beneath a shell that does not touch it stays at rest", "[box2d][injected]") {
    // What the floor gives an uncoupled crate was added to what had been learnt before, by g every frame: the first
    // touch threw it up at 7 m/s.
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double scale : {1.0, 50.0})
            for (const bool sleeps : {true, false}) {
                GameWorld g(quality, {.scale = scale, .density = 20.0F, .friction = 0.5F});
                g.floor();
                (void)g.shells.create(GameWorld::dome(1.0, {0.0, 1.02})).value();
                b2Body* crate = g.box(0.061F, 0.31F, 0.3F, 0.3F, b2_dynamicBody);
                crate->SetSleepingAllowed(sleeps);
                double fastest = 0.0, learnt = 0.0;
                for (int i = 0; i < 600; ++i) {
                    g.frame();
                    if (i >= 60) // it has landed
                        fastest = std::max(fastest, static_cast<double>(crate->GetLinearVelocity().Length() / g.L));
                    for (const step::Body& b : g.shells.world().bodies)
                        if (i >= 60 && b.dynamic)
                            learnt = std::max(learnt, b.hostCoupling.all.linear.norm());
                }
                CAPTURE(static_cast<int>(quality), scale, sleeps);
                CHECK(fastest < 0.01);       // Box2D's own slop
                CHECK(learnt < 1.01 * 9.81); // the floor carries the weight, and no more
            }
}
