// Islands of shells and Box2D's bodies come to rest together, sleep at no cost, and wake when something happens to
// them.

#include "tests/bridge/box2d/game_world.h"

#include <functional>
#include <map>

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

constexpr int kSecond = 60; ///< frames

struct Level : GameWorld {
    explicit Level(Quality quality = Quality::Game, double scale = 1.0, bool sleeps = true)
        : GameWorld(quality, {.scale = scale, .density = 20.0F, .friction = 0.5F}) {
        ground = floor();
        SleepSettings s;
        s.automatic = sleeps;
        shells.set_sleep(s).or_fail();
    }
    /// Half a circle of radius 0.5 m that stands on the floor.
    ShellHandle dome(double x) {
        ShellDef d = GameWorld::dome(0.5, {x, 0.53});
        d.mu = 0.5;
        return shells.create(d).value();
    }
    /// 0.6 m wide, 0.4 m high.
    b2Body* crate(float x, float y) { return box(x, y, 0.3F, 0.2F, b2_dynamicBody); }
    b2Body* ball(float x, float y, float radius, float speed = 0.0F) {
        b2CircleShape s;
        s.m_radius = L * radius;
        b2Body* b = fixture(body(b2_dynamicBody, x, y), s)->GetBody();
        b->SetLinearVelocity({0.0F, -L * speed});
        return b;
    }
    [[nodiscard]] bool asleep(ShellHandle s) const { return *shells.asleep(s); }
    [[nodiscard]] b2Vec2 at(const b2Body* b) const { return (1.0F / L) * b->GetPosition(); }
    [[nodiscard]] double thickness() const { return shells.world().rods.front().model.definition().thickness; }
    void frames(int n, const std::function<void()>& each = {}) {
        for (int i = 0; i < n; ++i) {
            frame();
            if (each)
                each();
        }
    }
    /// Until all shells sleep, at most `seconds`.
    void rest(int seconds = 5) {
        const auto sleeps = [&] {
            const auto& rods = shells.world().rods;
            return std::all_of(rods.begin(), rods.end(), [](const step::Rod& r) { return r.asleep(); });
        };
        for (int i = 0; i < seconds * kSecond && !sleeps(); ++i)
            frame();
        REQUIRE(sleeps());
    }

    b2Body* ground = nullptr;
};

/// A dome with a crate on it, at rest.
struct Couple : Level {
    explicit Couple(Quality quality = Quality::Game, double scale = 1.0, bool sleeps = true)
        : Level(quality, scale, sleeps), shell(dome(0.0)), box(crate(0.0F, 0.76F)) {
        if (sleeps)
            rest();
        else
            frames(5 * kSecond);
    }
    [[nodiscard]] bool sleeps() const {
        CHECK(asleep(shell) == !box->IsAwake());
        return asleep(shell);
    }

    ShellHandle shell;
    b2Body* box;
};

double distance(const b2Vec2& a, const b2Vec2& b) {
    return static_cast<double>((a - b).Length());
}

} // namespace

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
        g.world.DestroyBody(crate);
        g.frame();
        CHECK_FALSE(g.asleep(shell));
        const double low = g.shells.section(shell, 0.5)->position.y;
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
