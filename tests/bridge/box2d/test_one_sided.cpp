// One-sided ledges carry from above and let pass from below.

#include "tests/bridge/box2d/game_world.h"
#include "tests/support/share.h"

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

struct LedgeLevel : GameWorld {
    explicit LedgeLevel(Quality quality, double scale = 1.0) : GameWorld(quality, {.scale = scale}) {}
    /// Carries from above. A chain of four edges, or one edge with ghost vertices.
    b2Body* ledge(float y, bool chain, b2BodyType type = b2_staticBody) {
        b2Body* b = body(type, 0.0F, y);
        addLedge(b, 0.0F, chain);
        return b;
    }
    void addLedge(b2Body* to, float y, bool chain, float half = 9.0F) {
        if (chain) {
            const b2Vec2 v[] = {
                {half * L, y * L}, {0.3F * L, y * L}, {0.0F, y * L}, {-0.4F * L, y * L}, {-half * L, y * L}};
            b2ChainShape s;
            s.CreateChain(v, 5, {2.0F * half * L, y * L}, {-2.0F * half * L, y * L});
            fixture(to, s);
        } else {
            b2EdgeShape s;
            s.SetOneSided({2.0F * half * L, y * L}, {half * L, y * L}, {-half * L, y * L}, {-2.0F * half * L, y * L});
            fixture(to, s);
        }
    }
    /// Its middle at a place; `arch`: a half circle, else a strip; both are 1.1 m long.
    ShellHandle shell(double y, double angle, bool arch, double x = 0.07) {
        ShellDef d = scaled_shell(0.35, 0.4, 0.5, 60.0);
        d.elements = 10;
        if (!arch)
            d.natural_curvature.assign(10, 0.0);
        d.position = {x, y};
        d.angle = angle;
        return shells.create(d).value();
    }
    void frame() {
        GameWorld::frame();
        REQUIRE(shells.events().quarantined.empty());
        CHECK(shells.events().overlapping.empty());
    }
    [[nodiscard]] Box box(ShellHandle h) const { return shells.state(h).value().box; }
    [[nodiscard]] std::uint64_t crossings() const {
        const step::Counters& c = shells.world().counters;
        return c.crossings + c.rejectedFor[static_cast<std::size_t>(step::Reason::Crossing)];
    }
    [[nodiscard]] std::uint64_t tooDeep() const {
        return shells.world().counters.rejectedFor[static_cast<std::size_t>(step::Reason::Penetration)];
    }
    [[nodiscard]] double thickness() const { return shells.world().rods[0].model.definition().thickness; }
};

} // namespace

TEST_CASE("a shell thrown up through a one-sided ledge passes, and is carried from above", "[box2d][one_sided]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const bool chain = GENERATE(true, false), arch = GENERATE(true, false);
    const double scale = chain == arch ? 1.0 : 50.0; // with both qualities: every pair of these choices
    const double angle = GENERATE(0.0, 0.7, 1.5707);
    const double speed = GENERATE(1.5, 3.0, 4.0, 5.0, 6.6); // rises 0.1 to 2.2 m: below, half through, above
    CAPTURE(static_cast<int>(quality), scale, chain, arch, angle, speed);
    LedgeLevel level(quality, scale);
    level.ledge(0.0F, chain);
    level.ledge(-4.0F, chain);
    const ShellHandle shell = level.shell(-0.75, angle, arch);
    level.shells.set_velocity(shell, {0.0, speed}).or_fail();
    bool above = false;
    for (int i = 0; i < 150; ++i) {
        level.frame();
        const Box now = level.box(shell);
        if (above)
            REQUIRE(now.lower.y > -0.2 * level.thickness()); // its surface; it does not sink in
        if (!above && i < 45) // it has touched nothing yet: the ledge below is 0.9 s away
            CHECK(level.tooDeep() == 0);
        above = above || now.lower.y > 0.0;
    }
    CHECK(level.crossings() == 0);
    if (speed == 6.6)
        CHECK(above);
    if (speed == 1.5)
        CHECK(level.box(shell).upper.y < 0.0);
}

TEST_CASE("a one-sided ledge moves down past a shell", "[box2d][one_sided]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const bool chain = GENERATE(true, false), arch = GENERATE(true, false);
    const float speed = GENERATE(0.2F, 1.0F, 5.0F);
    CAPTURE(static_cast<int>(quality), chain, arch, speed);
    LedgeLevel level(quality);
    level.ledge(0.0F, chain);
    b2Body* moving = level.ledge(0.8F, chain, b2_kinematicBody);
    const ShellHandle shell = level.shell(0.2, 0.1, arch);
    for (int i = 0; i < 30; ++i)
        level.frame();
    moving->SetLinearVelocity({0.0F, -speed});
    for (int i = 0; i < 60 + static_cast<int>(60.0F / speed); ++i)
        level.frame();
    CHECK(level.crossings() == 0);
    CHECK(level.box(shell).lower.y > -0.2 * level.thickness()); // the ledge that stays carries it
    CHECK(level.box(shell).lower.y < 0.05);
}

TEST_CASE("two one-sided ledges closer than a shell is thick", "[box2d][one_sided]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const bool chain = GENERATE(true, false), arch = GENERATE(true, false);
    const double apart = GENERATE(0.1, 0.45, 0.55, 0.9); // thicknesses
    const bool below = chain == arch;                    // every pair of these choices
    CAPTURE(static_cast<int>(quality), chain, arch, apart, below);
    LedgeLevel level(quality);
    const ShellHandle shell = level.shell(below ? -0.75 : 0.4, 0.3, arch);
    level.ledge(0.0F, chain);
    level.ledge(static_cast<float>(-apart * level.thickness()), chain);
    if (below)
        level.shells.set_velocity(shell, {0.0, 6.5}).or_fail();
    for (int i = 0; i < 150; ++i)
        level.frame();
    CHECK(level.crossings() == 0);
    CHECK(level.box(shell).lower.y > -0.2 * level.thickness());
}

TEST_CASE("a shell on its way through a ledge stands on the ground of the same body", "[box2d][one_sided]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const bool chain = GENERATE(true, false);
    CAPTURE(static_cast<int>(quality), chain);
    LedgeLevel level(quality);
    b2Body* ground = level.ledge(0.0F, chain);
    level.addLedge(ground, 0.25F, chain);
    const ShellHandle shell = level.shell(0.02, 0.0, false);
    const HoldHandle hold = level.shells.create_pin(shell, 1.0).value();
    for (int i = 0; i < 90; ++i) { // one end is drawn up through the ledge, the other one drags on the ground
        TargetDef to = level.shells.target(hold).value();
        to.position.y = std::min(0.35, to.position.y + 0.01);
        level.shells.set_target(hold, to).or_fail();
        level.frame();
    }
    CHECK(level.shells.section(shell, 1.0).value().position.y == Approx(0.35));
    CHECK(level.box(shell).lower.y > -0.2 * level.thickness());
    CHECK(level.crossings() == 0);
}

namespace {

void throwSideways(test::Share share) {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const bool chain : {true, false})
            for (const bool arch : {true, false})
                for (const double lean : {-0.4, -0.1, 0.0, 0.1, 0.4}) // its foot is first, or its head
                    for (const double rise : {-0.3, 0.0, 0.3}) {
                        if (!share.next())
                            continue;
                        CAPTURE(static_cast<int>(quality), chain, arch, lean, rise);
                        LedgeLevel level(quality);
                        level.addLedge(level.body(b2_staticBody, 0.0F, 0.0F), 0.0F, chain, 0.5F);
                        level.ledge(-3.0F, chain);
                        const ShellHandle shell = level.shell(0.0, 0.5 * M_PI + lean, arch, -1.0);
                        level.shells.set_velocity(shell, {4.0, rise + 0.6}).or_fail();
                        for (int i = 0; i < 120; ++i)
                            level.frame();
                        CHECK(level.shells.world().counters.crossings == 0); // a step may be cut
                        CHECK(level.box(shell).lower.y > -3.0 - 0.2 * level.thickness());
                    }
}

} // namespace

TEST_CASE("a shell thrown sideways against the end of a one-sided ledge", "[box2d][one_sided]") {
    throwSideways(test::Share(7));
}

TEST_CASE("a shell thrown sideways in every way against the end of a one-sided ledge", "[box2d][one_sided][slow]") {
    throwSideways(test::Share(1));
}

TEST_CASE("a sharp ridge of a one-sided chain carries a shell", "[box2d][one_sided]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    const float half = GENERATE(0.1F, 0.3F, 1.0F); // of the foot of a ridge of 0.5 m, which turns by up to 157 degrees
    const double x = GENERATE(0.0, 0.05);          // off its middle it slides down one flank
    CAPTURE(static_cast<int>(quality), half, x);
    LedgeLevel level(quality);
    const b2Vec2 v[] = {{5.0F, 0.0F}, {half, 0.0F}, {0.0F, 0.5F}, {-half, 0.0F}, {-5.0F, 0.0F}};
    b2ChainShape ridge;
    ridge.CreateChain(v, 5, {6.0F, 0.0F}, {-6.0F, 0.0F});
    level.fixture(level.body(b2_staticBody, 0.0F, 0.0F), ridge)->SetFriction(0.5F);
    const ShellHandle shell = level.shell(0.7, 0.0, false, x);
    for (int i = 0; i < 40; ++i)
        level.frame();
    if (x == 0.0)
        CHECK(level.shells.section(shell, 0.5).value().position.y > 0.5);
    for (int i = 0; i < 120; ++i)
        level.frame();
    CHECK(level.crossings() == 0);
    CHECK(level.box(shell).lower.y > -0.2 * level.thickness());
}

TEST_CASE("a dome of a few large elements stands on a ridge inside it", "[box2d][one_sided]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    CAPTURE(static_cast<int>(quality));
    LedgeLevel level(quality);
    // The ridge is 0.02 m below the top, above the chords of the elements.
    const b2Vec2 v[] = {{5.0F, 0.0F}, {0.2F, 0.0F}, {0.0F, 0.7F}, {-0.2F, 0.0F}, {-5.0F, 0.0F}};
    b2ChainShape ridge;
    ridge.CreateChain(v, 5, {6.0F, 0.0F}, {-6.0F, 0.0F});
    level.fixture(level.body(b2_staticBody, 0.0F, 0.0F), ridge)->SetFriction(0.5F);
    ShellDef d = scaled_shell(0.5, 1.0, 0.5, 60.0);
    d.elements = 3;
    d.position = {0.0, 0.73};
    d.angle = M_PI;
    const ShellHandle shell = level.shells.create(d).value();
    for (int i = 0; i < 60; ++i)
        level.frame();
    CHECK(level.crossings() == 0);
    CHECK(level.shells.section(shell, 0.5).value().position.y > 0.7);
}

TEST_CASE("a shell half way through a ledge is part of a saved state", "[box2d][one_sided]") {
    const Quality quality = GENERATE(Quality::Game, Quality::Laboratory);
    LedgeLevel level(quality);
    level.ledge(0.0F, true);
    const ShellHandle shell = level.shell(-0.75, 1.3, false);
    level.shells.set_velocity(shell, {0.0, 4.0}).or_fail();
    while (level.box(shell).upper.y < 0.15)
        level.frame();
    REQUIRE(level.box(shell).lower.y < 0.0);
    const Snapshot then = Snapshot::from_bytes(level.shells.save().bytes()).value();
    std::uint64_t hash[2] = {};
    for (std::uint64_t& h : hash) {
        level.shells.restore(then).or_fail();
        for (int i = 0; i < 60; ++i)
            level.frame();
        h = level.shells.hash();
    }
    CHECK(hash[0] == hash[1]);
    CHECK(level.crossings() == 0);
}
