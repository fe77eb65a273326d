// Corrections of joints, holds, contacts and copies add no motion.

#include "tests/bridge/box2d/game_world.h"

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
