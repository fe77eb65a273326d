// Pairs that cross when made, teleported, restored or covered by a body part gently: none is quarantined, no step is
// cut for them, none is faster than 20 thicknesses a second, and in the end nothing crosses.

#include "tests/bridge/box2d/game_world.h"
#include "tests/support/crossings.h"

using namespace supercircle;
using namespace supercircle::bridge_test;

namespace {

constexpr double kThickness = 0.02604; ///< m, of scaled_shell(1, 2, 0.5)
constexpr double kPush = 20.0 * kThickness;

/// Of a frame: impacts are made of steps of 0.25 ms, what parts at speed of shorter ones; of dtMin it would be 16 000.
constexpr std::uint64_t kMostSteps = 300;

struct OverlapGame : GameWorld {
    explicit OverlapGame(Quality quality, double units = 1.0, float gravity = -9.81F)
        : GameWorld(quality, {.scale = units, .gravity = gravity, .density = 20.0F, .friction = 0.5F}) {}
    static ShellDef dome(double x, double y, double angle = M_PI) { return GameWorld::dome(1.0, {x, y}, angle); }
    ShellHandle shell(double x, double y, double angle = M_PI) { return shells.create(dome(x, y, angle)).value(); }
    void frame() {
        const FrameReport r = GameWorld::frame();
        CHECK(r.advanced == Approx(kFrame));
        CHECK(r.quarantined.empty());
        overlapping += shells.events().overlapping.size();
        mostSteps = std::max(mostSteps, r.steps);
        fastest = std::max(fastest, speed());
    }
    void run(double seconds) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kFrame)); ++i)
            frame();
    }
    [[nodiscard]] std::size_t crossings() const { return test::crossings(shells); }
    void checkApart() {
        CHECK(crossings() == 0);
        CHECK(shells.world().overlaps.empty());
        CHECK(shells.world().counters.crossings == 0);
        CHECK(mostSteps <= kMostSteps);
        CHECK(std::abs(shells.energy_balance().residual) < 1e-9);
    }

    std::size_t overlapping = 0; ///< events
    std::uint64_t mostSteps = 0; ///< of one frame
    double fastest = 0.0;        ///< m/s
};

template <class Test>
void inAll(Test test) {
    for (const Quality quality : {Quality::Game, Quality::Laboratory})
        for (const double units : {1.0, 50.0}) {
            INFO((quality == Quality::Game ? "game, " : "laboratory, ") << units << " units/m");
            test(quality, units);
        }
}

} // namespace

TEST_CASE("two strangers made across each other part at a bounded speed", "[box2d][overlap]") {
    for (const double angle : {0.5, -0.9, 1.2}) // without gravity, so that only the push moves them
        inAll([&](Quality quality, double units) {
            OverlapGame g(quality, units, 0.0F);
            const ShellHandle a = g.shell(0.0, 0.0), b = g.shell(0.7, 0.0, M_PI + angle);
            REQUIRE(g.crossings() > 0);
            g.frame();
            REQUIRE(g.shells.events().overlapping.size() == 1);
            CHECK(g.shells.events().overlapping[0].a == a);
            CHECK(g.shells.events().overlapping[0].b == b);
            CHECK(g.shells.events().overlapping[0].body == 0);
            g.run(5.0);
            CHECK(g.overlapping == 0 + 1);
            g.checkApart();
            // The pushed points part at 20 h/s; the free end of a shell that turns about its middle is twice as fast.
            CHECK(g.fastest < 2.0 * kPush);
        });
}

TEST_CASE("strangers on a floor part and rest", "[box2d][overlap]") {
    inAll([](Quality quality, double units) {
        OverlapGame g(quality, units);
        g.floor();
        g.shell(0.0, 1.02);
        g.shell(0.7, 1.02);
        g.run(6.0);
        CHECK(g.overlapping == 1);
        g.checkApart();
        CHECK(g.fastest < std::sqrt(2.0 * 9.81 * 0.6)); // one is lifted by its own height at most
    });
}

TEST_CASE("a shell made with its tips in the floor rises", "[box2d][overlap]") {
    for (const double deep : {0.25, 0.75, 2.0})
        inAll([&](Quality quality, double units) {
            OverlapGame g(quality, units);
            g.floor();
            const ShellHandle s = g.shell(0.0, 1.0 - deep * kThickness);
            g.run(2.0);
            CHECK(g.overlapping == 1);
            g.checkApart();
            CHECK(g.fastest < 2.0 * kPush);
            CHECK(g.shells.state(s)->box.lower.y > -0.01 * kThickness);
        });
}

TEST_CASE("a shell made with its tips behind a chain rises to its front", "[box2d][overlap]") {
    for (const double deep : {0.5, 1.0, 5.0})
        inAll([&](Quality quality, double units) {
            OverlapGame g(quality, units);
            const b2Vec2 points[] = {
                {5.0F * g.L, 0.0F}, {2.0F * g.L, 0.0F}, {0.0F, 0.0F}, {-2.0F * g.L, 0.0F}, {-5.0F * g.L, 0.0F}};
            b2ChainShape chain;
            chain.CreateChain(points, 5, {6.0F * g.L, 0.0F}, {-6.0F * g.L, 0.0F});
            b2BodyDef def;
            g.world.CreateBody(&def)->CreateFixture(&chain, 0.0F);
            const ShellHandle s = g.shell(0.0, 1.0 - deep * kThickness);
            g.run(3.0);
            CHECK(g.overlapping == 1); // the edges of a chain are one body
            g.checkApart();
            CHECK(g.fastest < 2.0 * kPush);
            CHECK(g.shells.state(s)->box.lower.y > -0.01 * kThickness);
        });
}

TEST_CASE("a shell inside a solid or through a wall comes out", "[box2d][overlap]") {
    inAll([](Quality quality, double units) { // wholly inside the floor
        OverlapGame g(quality, units);
        g.floor();
        g.shell(0.0, -0.1, 0.0);
        g.run(4.0);
        g.checkApart();
        CHECK(g.fastest < 2.0 * kPush + std::sqrt(2.0 * 9.81 * 0.1));
    });
    for (const float x : {1.0F, 0.97F}) // a post of a hand's breadth through the foot of a dome
        inAll([&](Quality quality, double units) {
            OverlapGame g(quality, units);
            g.floor();
            g.shell(0.0, 1.02);
            g.box(x, 0.5F, 0.05F, 0.5F);
            g.run(5.0);
            g.checkApart();
            CHECK(g.fastest < 4.0 * kPush);
        });
    inAll([](Quality quality, double units) { // a sheet through the top, half above and half below: only up is free
        OverlapGame g(quality, units);
        g.floor();
        g.shell(0.0, 1.02);
        g.box(0.3F, 1.0F, 0.02F, 0.5F);
        g.run(8.0);
        g.checkApart();
    });
}

TEST_CASE("a shell teleported across another one parts from it", "[box2d][overlap]") {
    inAll([](Quality quality, double units) {
        OverlapGame g(quality, units);
        g.floor();
        g.shell(0.0, 1.02);
        const ShellHandle b = g.shell(5.0, 1.02);
        g.run(1.0);
        REQUIRE(g.overlapping == 0);
        REQUIRE(g.shells.teleport(b, {0.6, 1.3}, M_PI + 0.3));
        g.run(6.0);
        CHECK(g.overlapping == 1);
        g.checkApart();
    });
}

TEST_CASE("a crate put onto a shell and the shell part", "[box2d][overlap]") {
    inAll([](Quality quality, double units) {
        OverlapGame g(quality, units);
        g.floor();
        const ShellHandle s = g.shell(0.0, 1.02);
        g.run(1.0);
        b2Body* crate = g.box(0.1F, 0.9F, 0.3F, 0.3F, b2_dynamicBody);
        double fastest = 0.0;
        for (int i = 0; i < 120; ++i) {
            g.frame();
            fastest = std::max(fastest, static_cast<double>(crate->GetLinearVelocity().Length()) / units);
        }
        REQUIRE(g.overlapping == 1);
        g.checkApart();
        CHECK(fastest < std::sqrt(2.0 * 9.81 * 0.6) + kPush); // it falls to the floor at most
        CHECK(g.shells.state(s)->box.upper.y > 0.9);          // and does not crush the shell
    });
}

TEST_CASE("an overlap is part of a saved state", "[box2d][overlap]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory}) {
        OverlapGame g(quality);
        g.floor();
        g.shell(0.0, 1.02);
        g.shell(0.7, 1.02);
        g.run(0.5);
        REQUIRE_FALSE(g.shells.world().overlaps.empty());
        const Snapshot then = Snapshot::from_bytes(g.shells.save().bytes()).value();
        g.run(3.0);
        const std::uint64_t first = g.shells.hash();
        const std::size_t events = g.overlapping;
        REQUIRE(g.shells.restore(then));
        g.run(3.0);
        CHECK(g.shells.hash() == first);
        CHECK(g.overlapping == events); // it is known already
        g.run(3.0);
        g.checkApart();
    }
}

TEST_CASE("a pile beside an overlapping pair stands as without it", "[box2d][overlap]") {
    for (const Quality quality : {Quality::Game, Quality::Laboratory}) {
        double top[2] = {};
        for (const bool pair : {false, true}) {
            OverlapGame g(quality);
            g.floor();
            std::vector<ShellHandle> pile;
            for (int i = 0; i < 6; ++i)
                pile.push_back(g.shell(20.0, 1.02 + 0.2 * i));
            g.run(3.0);
            if (pair) {
                g.shell(0.0, 1.02);
                g.shell(0.7, 1.02);
            }
            g.run(3.0);
            CHECK(g.overlapping == (pair ? 1 : 0));
            CHECK(g.mostSteps <= kMostSteps);
            top[pair ? 1 : 0] = g.shells.state(pile.back())->box.upper.y;
        }
        CHECK(std::abs(top[1] - top[0]) < 0.1 * kThickness); // the pair's steps are others: the pile creeps otherwise
    }
}

TEST_CASE("fits tells whether a shell would cross something", "[box2d][overlap]") {
    for (const double units : {1.0, 50.0}) {
        OverlapGame g(Quality::Game, units);
        g.floor();
        CHECK(g.shells.fits(OverlapGame::dome(0.0, 1.02)).value());
        CHECK_FALSE(g.shells.fits(OverlapGame::dome(0.0, 0.99)).value()); // tips in the floor
        CHECK_FALSE(g.shells.fits(OverlapGame::dome(0.0, -0.1, 0.0)).value());
        g.shell(0.0, 1.02);
        CHECK_FALSE(g.shells.fits(OverlapGame::dome(0.7, 1.02)).value()); // before the first frame as well
        CHECK(g.shells.fits(OverlapGame::dome(2.1, 1.02)).value());
        ShellDef ghost = OverlapGame::dome(0.7, 1.02);
        ghost.mask = 2; // the other shell is in category 1, and so is the floor
        CHECK(g.shells.fits(ghost).value());
        g.box(2.1F, 2.0F, 0.2F, 0.02F);
        CHECK(g.shells.fits(OverlapGame::dome(2.1, 1.02)).value());
        g.box(2.1F, 1.0F, 0.2F, 0.1F);
        CHECK_FALSE(g.shells.fits(OverlapGame::dome(2.1, 1.02)).value());
        ghost.thickness = -1.0;
        CHECK_FALSE(g.shells.fits(ghost));
        CHECK(g.shells.size() == 1);
    }
}

TEST_CASE("a shell passes a one-sided edge from behind and lands on its front if it gets through", "[box2d][overlap]") {
    inAll([](Quality quality, double units) {
        for (const double speed : {6.0, 7.0})
            for (const double angle : {0.0, M_PI}) {
                OverlapGame g(quality, units);
                b2BodyDef def;
                b2EdgeShape
                    edge; // front above: the solid is on the right of the way from the first vertex to the second
                edge.SetOneSided({6.0F * g.L, 2.0F * g.L}, {5.0F * g.L, 2.0F * g.L}, {-5.0F * g.L, 2.0F * g.L},
                                 {-6.0F * g.L, 2.0F * g.L});
                g.world.CreateBody(&def)->CreateFixture(&edge, 0.0F)->SetFriction(0.5F);
                ShellDef d = scaled_shell(0.4, 2.0, 0.5);
                d.position = {0.0, 0.5};
                d.angle = angle;
                d.velocity = {0.0, speed};
                const ShellHandle s = g.shells.create(d).value();
                const double highest = g.shells.state(s)->box.lower.y + speed * speed / (2.0 * 9.81);
                g.run(3.0);
                CHECK(g.overlapping == 0); // it moved there
                CHECK(g.shells.world().counters.crossings == 0);
                CHECK(g.mostSteps <= kMostSteps);
                const step::Counters& c = g.shells.world().counters;
                const auto count = [&](step::Reason r) { return c.rejectedFor[static_cast<std::size_t>(r)]; };
                // All but what makes an impact accurate; it may be too much for the step before it.
                CHECK(c.rejected - count(step::Reason::StatusChange) - count(step::Reason::LocalError) <= 2);
                const EnergyBalance b = g.shells.energy_balance();
                CHECK(b.kinetic + b.bending + b.gravity <= b.added + 1e-9);
                if (highest > 2.0) {
                    CHECK(g.shells.state(s)->box.lower.y > 2.0 - 0.02 * d.thickness);
                } else { // half through it falls back
                    CHECK(g.shells.state(s)->box.upper.y < 0.0);
                }
            }
    });
}
