// Stacks and neighbours of shells and bodies sleep as what hangs together.

#include "tests/bridge/box2d/sleep_level.h"

using namespace supercircle;
using namespace supercircle::bridge_test;

TEST_CASE("three crates on two shells sleep together and wake together", "[box2d][sleep]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Level g(quality, scale);
    const std::vector<ShellHandle> domes{g.dome(-0.6), g.dome(0.6)};
    const std::vector<b2Body*> crates{g.box(0.0F, 0.68F, 1.0F, 0.1F, b2_dynamicBody), g.crate(0.0F, 1.0F),
                                      g.crate(0.0F, 1.42F)};
    const auto sleepers = [&] {
        const auto shells = std::count_if(domes.begin(), domes.end(), [&](ShellHandle s) { return g.asleep(s); });
        const auto boxes = std::count_if(crates.begin(), crates.end(), [](b2Body* b) { return !b->IsAwake(); });
        return shells + boxes;
    };
    for (int i = 0; i < 10 * kSecond && sleepers() < 5; ++i) {
        g.frame();
        CHECK((sleepers() == 0 || sleepers() == 5));
    }
    REQUIRE(sleepers() == 5);
    const auto& rods = g.shells.world().rods;
    CHECK(rods[0].island == rods[1].island);
    std::vector<b2Vec2> places;
    for (const b2Body* b : crates)
        places.push_back(g.at(b));
    g.frames(kSecond, [&] { CHECK(sleepers() == 5); });
    g.shells.wake(domes[1]).or_fail();
    g.frame();
    CHECK(sleepers() == 0);
    double farthest = 0.0;
    for (std::size_t k = 0; k < crates.size(); ++k)
        farthest = std::max(farthest, distance(g.at(crates[k]), places[k]));
    CHECK(farthest < 1e-4);
    for (int i = 0; i < 10 * kSecond && sleepers() < 5; ++i)
        g.frame();
    REQUIRE(sleepers() == 5);
    crates[2]->ApplyLinearImpulseToCenter({0.05F * crates[2]->GetMass() * static_cast<float>(scale), 0.0F}, true);
    g.frame();
    CHECK(sleepers() == 0);
}

TEST_CASE("a sleeping island wakes when its floor, its crate or its shell is taken away", "[box2d][sleep]") {
    Level g;
    const ShellHandle shell = g.dome(0.0);
    b2Body* const crate = g.crate(0.0F, 0.76F);
    g.rest();
    SECTION("the crate") {
        const double low = g.shells.section(shell, 0.5)->position.y;
        g.world.DestroyBody(crate);
        g.frame();
        CHECK_FALSE(g.asleep(shell));
        g.frames(kSecond / 2);
        CHECK(g.shells.section(shell, 0.5)->position.y > low + 0.01 * g.thickness()); // the load is off
    }
    SECTION("the floor") {
        g.world.DestroyBody(g.ground);
        const float before = g.at(crate).y;
        g.frame();
        CHECK_FALSE(g.asleep(shell));
        CHECK(crate->IsAwake());
        g.frames(kSecond / 2);
        CHECK(g.at(crate).y < before - 1.0F);
    }
    SECTION("the shell") {
        g.shells.destroy(shell).or_fail();
        g.frame();
        CHECK(crate->IsAwake());
        g.frames(kSecond);
        CHECK(g.at(crate).y < 0.25F);
    }
    SECTION("the crate is switched off") {
        crate->SetEnabled(false);
        g.frame();
        CHECK_FALSE(g.asleep(shell));
    }
    SECTION("the crate becomes static") {
        crate->SetType(b2_staticBody);
        g.frame();
        CHECK_FALSE(g.asleep(shell));
        g.rest();
    }
}

TEST_CASE("a shell that falls on a sleeping crate wakes it", "[box2d][sleep]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Couple g(quality, scale);
    const ShellHandle falling = g.strip(0.0, 1.6);
    bool passed = false;
    int woken = -1;
    for (int i = 0; i < kSecond; ++i) {
        passed = passed || (g.sleeps() && g.shells.section(falling, 0.5)->position.y > 1.2);
        g.frame();
        if (woken < 0 && !g.sleeps())
            woken = i;
    }
    CHECK(passed); // not before it is there
    CHECK(woken > 0);
    CHECK(g.shells.section(falling, 0.5)->position.y > g.at(g.box).y + 0.15);
    CHECK(g.shells.world().counters.crossings == 0);
}

TEST_CASE("what sleeps far away takes no work and changes no bit of what moves", "[box2d][sleep]") {
    Level alone, crowded;
    std::vector<b2Body*> far;
    for (int i = 0; i < 6; ++i) {
        crowded.dome(6.0 + 1.2 * i);
        far.push_back(crowded.crate(6.0F + 1.2F * static_cast<float>(i), 0.76F));
    }
    crowded.rest(10);
    while (alone.shells.time() < crowded.shells.time()) // its digits decide those of times within a frame
        alone.frame();
    for (const b2Body* b : far)
        REQUIRE_FALSE(b->IsAwake());
    REQUIRE(crowded.frame().work == 0.0);
    alone.frame();
    REQUIRE(alone.shells.time() == crowded.shells.time());
    const ShellHandle a = alone.bumper({0.0, 0.8}, 0.3), b = crowded.bumper({0.0, 0.8}, 0.3);
    b2Body* const boxes[] = {alone.crate(0.1F, 1.8F), crowded.crate(0.1F, 1.8F)};
    for (int i = 0; i < 3 * kSecond; ++i) {
        const FrameReport x = alone.frame(), y = crowded.frame();
        CAPTURE(i);
        REQUIRE(x.work == y.work);
        REQUIRE(x.steps == y.steps);
        REQUIRE(alone.shells.pose(a)->curvature == crowded.shells.pose(b)->curvature);
        REQUIRE(boxes[0]->GetPosition() == boxes[1]->GetPosition());
    }
    for (const b2Body* body : far)
        CHECK_FALSE(body->IsAwake());
}

TEST_CASE("crates on a kinematic platform that stands sleep on their shells too", "[box2d][sleep]") {
    Level g;
    b2Body* const platform = g.box(-0.9F, 0.3F, 0.3F, 0.3F, b2_kinematicBody);
    const ShellHandle shell = g.dome(0.0);
    b2Body* const plank = g.box(-0.4F, 0.75F, 0.8F, 0.05F, b2_dynamicBody);
    g.rest(10);
    CHECK_FALSE(plank->IsAwake());
    const b2Vec2 place = g.at(plank);
    g.frames(2 * kSecond, [&] { CHECK(g.asleep(shell)); });
    CHECK(g.at(plank) == place);
    platform->SetLinearVelocity({0.0F, 0.2F});
    g.frame();
    CHECK_FALSE(g.asleep(shell));
    CHECK(plank->IsAwake());
}

TEST_CASE("a crate beside a shell and the shell sleep, and wake each by itself", "[box2d][sleep]") {
    const double scale = GENERATE(1.0, 50.0);
    Level g(Quality::Game, scale);
    const ShellHandle shell = g.dome(0.0);
    b2Body* const beside = g.box(0.75F, 0.2F, 0.2F, 0.2F, b2_dynamicBody); // 5 cm away
    g.rest();
    CHECK_FALSE(beside->IsAwake());
    const b2Vec2 place = g.at(beside);
    g.frames(2 * kSecond, [&] { CHECK((g.asleep(shell) && !beside->IsAwake())); });
    CHECK(g.at(beside) == place);
    g.shells.apply_impulse(shell, 0.5, {0.0, 0.1}).or_fail();
    g.frame();
    CHECK_FALSE(g.asleep(shell));
    CHECK(distance(g.at(beside), place) < 1e-5); // nobody touches it
    g.rest();
    beside->ApplyLinearImpulseToCenter({-0.1F * g.L * beside->GetMass(), 0.0F}, true);
    g.frame();
    CHECK_FALSE(g.asleep(shell));
    g.rest();
    CHECK_FALSE(beside->IsAwake());
}

TEST_CASE("neighbours that do not touch do not keep each other awake", "[box2d][sleep]") {
    // Each plank reaches over to the next dome, within the distance at which a moving body wakes a shell.
    Level g;
    std::vector<b2Body*> planks;
    for (int i = 0; i < 4; ++i) {
        g.dome(1.1 * i);
        planks.push_back(g.box(1.1F * static_cast<float>(i), 0.6F, 0.52F, 0.05F, b2_dynamicBody));
        g.frames(11); // each has its own time to come to rest
    }
    g.rest();
    for (const b2Body* b : planks)
        CHECK_FALSE(b->IsAwake());
    g.frames(2 * kSecond, [&] { CHECK_FALSE(planks[1]->IsAwake()); });
}

TEST_CASE("bodies whose vertices shells see joined stay asleep", "[box2d][sleep]") {
    // Planks on planks, side by side: where vertices are joined depends on how the bodies lie in that frame.
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Level g(quality, scale);
    for (const double x : {-0.9, 0.0, 0.9})
        g.dome(x);
    std::vector<b2Body*> planks;
    for (const float y : {0.6F, 0.71F})
        for (const float x : {-0.501F, 0.501F}) {
            planks.push_back(g.box(x, y, 0.5F, 0.05F, b2_dynamicBody));
            planks.back()->SetAngularDamping(4.0F);
        }
    g.rest(15);
    g.frames(2 * kSecond, [&] {
        for (const b2Body* b : planks)
            CHECK_FALSE(b->IsAwake());
    });
}
