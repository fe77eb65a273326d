// A shell and the body of Box2D on it come to rest together, sleep at no cost, and wake when something happens to them.

#include "tests/bridge/box2d/sleep_level.h"

using namespace supercircle;
using namespace supercircle::bridge_test;

TEST_CASE("a shell under a crate sleeps within seconds, and its crate too", "[box2d][sleep]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Couple g(quality, scale);
    CHECK_FALSE(g.box->IsAwake());
    const ShellPose pose = *g.shells.pose(g.shell);
    const b2Vec2 place = g.box->GetPosition();
    g.frames(kSecond, [&] { CHECK(g.sleeps()); });
    const FrameReport r = g.frame();
    CHECK(r.steps == 0);
    CHECK(r.work == 0.0);
    CHECK(r.advanced == Approx(kFrame));
    CHECK(g.shells.pose(g.shell)->curvature == pose.curvature);
    CHECK(g.shells.pose(g.shell)->start.y == pose.start.y);
    CHECK(g.box->GetPosition() == place);
    CHECK_FALSE(g.shells.world().sleepingImpulses.empty());
}

TEST_CASE("a crate that rocks on a dome sleeps when its damping has stopped it", "[box2d][sleep]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Level g(quality, scale);
    const ShellHandle shell = g.dome(0.0);
    b2Body* const crate = g.crate(0.02F, 0.76F);
    crate->SetAngularDamping(2.0F);
    g.frames(kSecond, [&] { CHECK_FALSE((g.asleep(shell) || !crate->IsAwake())); });
    g.rest(9);
    CHECK_FALSE(crate->IsAwake());
}

TEST_CASE("a crate that sleeps and wakes for ten seconds stays where it is", "[box2d][sleep]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Couple g(quality, scale);
    const b2Vec2 place = g.at(g.box);
    double farthest = 0.0, moved = 0.0;
    int wakes = 0;
    for (int i = 0; i < 10 * kSecond; ++i) {
        const Point before = g.shells.section(g.shell, 0.5)->position;
        const bool slept = g.sleeps();
        if (i % kSecond == 10) {
            REQUIRE(slept);
            if (i / kSecond % 2 == 0)
                g.shells.wake(g.shell).or_fail();
            else
                g.box->SetAwake(true);
            ++wakes;
        }
        g.frame();
        const Point after = g.shells.section(g.shell, 0.5)->position;
        moved = std::max(moved, std::hypot(after.x - before.x, after.y - before.y));
        farthest = std::max(farthest, distance(g.at(g.box), place));
    }
    CHECK(wakes == 10);
    CHECK(farthest < 1e-4);
    CHECK(moved < 1e-3 * g.thickness());
}

TEST_CASE("a push on a sleeping crate wakes it and its shell in the same frame", "[box2d][sleep]") {
    const double scale = GENERATE(1.0, 50.0);
    const auto L = static_cast<float>(scale);
    using Hand = std::function<void(Couple&)>;
    const std::vector<std::pair<const char*, Hand>> hands{
        {"impulse",
         [&](Couple& g) {
             g.box->ApplyLinearImpulseToCenter({0.5F * L * g.box->GetMass(), 0.0F}, true);
         }},
        {"velocity",
         [&](Couple& g) {
             g.box->SetLinearVelocity({0.0F, 0.3F * L});
         }},
        {"spin", [](Couple& g) { g.box->SetAngularVelocity(0.5F); }},
        {"force",
         [&](Couple& g) {
             g.box->ApplyForceToCenter({0.0F, 20.0F * L * g.box->GetMass()}, true);
         }},
        {"another mass",
         [&](Couple& g) {
             g.box->GetFixtureList()->SetDensity(30.0F / (L * L));
             g.box->ResetMassData();
         }},
        {"another place",
         [&](Couple& g) { g.box->SetTransform(g.box->GetPosition() + b2Vec2(0.0F, 0.05F * L), 0.0F); }},
        {"no gravity for it", [](Couple& g) { g.box->SetGravityScale(0.0F); }},
        {"it must not sleep", [](Couple& g) { g.box->SetSleepingAllowed(false); }},
        {"a joint of Box2D's",
         [](Couple& g) {
             b2Body* other = g.crate(2.0F, 0.25F);
             b2DistanceJointDef d;
             d.Initialize(g.box, other, g.box->GetPosition(), other->GetPosition());
             g.world.CreateJoint(&d);
         }},
        {"a joint with an awake shell", [](Couple& g) {
             const ShellHandle other = g.strip(0.0, g.at(g.box).y + 0.5);
             REQUIRE(g.join(other, 0.5, *g.box, JointKind::Tether, 0.6));
         }}};
    for (const auto& [what, hand] : hands) {
        CAPTURE(scale, what);
        Couple g(Quality::Game, scale);
        REQUIRE(g.sleeps());
        const b2Vec2 before = g.at(g.box);
        hand(g);
        const FrameReport r = g.begin();
        CHECK_FALSE(g.asleep(g.shell));
        g.end(r).or_fail();
        CHECK_FALSE(g.sleeps());
        CHECK(r.steps > 0);
        CHECK(distance(g.at(g.box), before) < 0.06);
        CHECK(g.at(g.box).y > 0.7F); // it stands
    }
}

TEST_CASE("a sleeping crate takes a blow as one that is awake does", "[box2d][sleep]") {
    // What sleeps is in the state it would be in awake, so that the motion after a blow is the same but for the creep
    // of what did not sleep: a fiftieth of a thickness. A ball in a hurry meets the crate within the host's step.
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    const float speed = GENERATE(0.0F, 3.0F, 9.0F);
    const bool bullet = GENERATE(false, true);
    CAPTURE(static_cast<int>(quality), scale, speed, bullet);
    Couple asleep(quality, scale), awake(quality, scale, false);
    double apart = 0.0;
    bool woken = false, before = false;
    b2Body* const balls[] = {asleep.ball(0.1F, 1.6F, 0.1F, speed), awake.ball(0.1F, 1.6F, 0.1F, speed)};
    for (b2Body* b : balls)
        b->SetBullet(bullet);
    for (int i = 0; i < kSecond; ++i) {
        asleep.frame();
        awake.frame();
        apart = std::max(apart, distance(asleep.at(asleep.box), awake.at(awake.box)));
        const bool sleeps = asleep.sleeps();
        const double gap = asleep.at(balls[0]).y - 0.1F - asleep.at(asleep.box).y - 0.2F;
        woken = woken || !sleeps;
        before = before || (!sleeps && gap > 0.15);
    }
    CHECK(woken);
    CHECK_FALSE(before);
    CHECK(apart < (bullet ? 0.5 : 0.02) * asleep.thickness());
    CHECK(asleep.shells.world().counters.crossings == 0);
}

TEST_CASE("a crate that the host wakes within its own step does not fall", "[box2d][sleep]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Couple g(quality, scale);
    const b2Vec2 place = g.at(g.box);
    for (int i = 0; i < 5; ++i) {
        const FrameReport r = g.begin();
        if (i == 0)
            g.box->SetAwake(true); // as a listener or continuous collision would
        g.end(r).or_fail();
        CHECK_FALSE(g.sleeps());
        CHECK(distance(g.at(g.box), place) < 2e-3 * g.thickness());
    }
}

TEST_CASE("bodies that may not sleep keep their island awake", "[box2d][sleep]") {
    for (const bool world : {false, true}) {
        Level g;
        const ShellHandle shell = g.dome(0.0);
        b2Body* const crate = g.crate(0.0F, 0.76F);
        b2Body* const upper = g.crate(0.0F, 1.17F);
        if (world)
            g.world.SetAllowSleeping(false);
        else
            upper->SetSleepingAllowed(false);
        g.frames(4 * kSecond, [&] { CHECK_FALSE((g.asleep(shell) || !crate->IsAwake() || !upper->IsAwake())); });
        g.world.SetAllowSleeping(true);
        upper->SetSleepingAllowed(true);
        g.rest();
        CHECK_FALSE(upper->IsAwake());
    }
}

TEST_CASE("Box2D does not put a crate to sleep whose shell still moves", "[box2d][sleep]") {
    // The hand that holds the shell sinks by 4 mm/s: less than Box2D's tolerance for bodies at rest.
    Level g(Quality::Game, 1.0, GENERATE(false, true));
    const ShellHandle shell = g.strip(0.0, 1.0);
    const HoldHandle hand = g.shells.create_clamp(shell, 0.5).value();
    b2Body* const crate = g.box(0.0F, 1.12F, 0.1F, 0.1F, b2_dynamicBody);
    g.frames(kSecond);
    TargetDef sinking;
    sinking.position = {0.0, 1.0};
    sinking.velocity = {0.0, -0.004};
    g.shells.set_target(hand, sinking).or_fail();
    g.frames(20);
    const float before = g.at(crate).y;
    g.frames(3 * kSecond, [&] {
        CHECK(crate->IsAwake());
        CHECK(static_cast<double>(crate->GetLinearVelocity().y) == Approx(-0.004).epsilon(0.02));
        CHECK_FALSE(g.asleep(shell));
    });
    CHECK(static_cast<double>(before - g.at(crate).y) == Approx(3.0 * 0.004).epsilon(0.01));
}

TEST_CASE("a sleeping island is saved and restored to the last bit", "[box2d][sleep]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const double scale = GENERATE(1.0, 50.0);
    CAPTURE(static_cast<int>(quality), scale);
    Couple g(quality, scale);
    const Snapshot saved = g.shells.save();
    const b2Transform place = g.box->GetTransform();
    const auto bits = [&](bool pushed) {
        g.frames(5);
        CHECK(g.sleeps());
        if (pushed)
            g.box->ApplyLinearImpulseToCenter({0.2F * g.L * g.box->GetMass(), 0.0F}, true);
        g.frames(8);
        const ShellPose p = *g.shells.pose(g.shell);
        std::vector<double> out{p.start.x, p.start.y, p.angle};
        out.insert(out.end(), p.curvature.begin(), p.curvature.end());
        for (const float v : {g.box->GetPosition().x, g.box->GetPosition().y, g.box->GetAngle(),
                              g.box->GetLinearVelocity().x, g.box->GetLinearVelocity().y})
            out.push_back(static_cast<double>(v));
        return out;
    };
    const auto restore = [&] {
        REQUIRE(g.shells.restore(saved));
        g.box->SetTransform(place.p, place.q.GetAngle());
        g.box->SetLinearVelocity(b2Vec2_zero);
        g.box->SetAngularVelocity(0.0F);
        g.box->SetAwake(false);
    };
    const std::vector<double> slept = bits(false);
    CHECK(g.sleeps());
    restore();
    CHECK(bits(false) == slept);
    restore();
    const std::vector<double> pushed = bits(true);
    CHECK_FALSE(g.sleeps());
    const std::uint64_t hash = g.shells.hash();
    restore();
    CHECK(bits(true) == pushed);
    CHECK(g.shells.hash() == hash);
}
