// Islands at rest sleep, take no time, and wake when they should.

#include "tests/plugin/api/support.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr double kRise = 0.0192 * (1.0 - 0.58778525229247313) + 0.5 * 0.0005; ///< m, of a dome's middle at rest

/// Shallow domes (108 degrees, openings down) on the ground, and stacks of two.
struct Level {
    std::shared_ptr<FakeHost> host = emptyHost(kG);
    std::unique_ptr<Shells> shells;
    std::vector<ShellHandle> domes;

    Level() {
        host->addGround(1, 0.5);
        host->add(2, "door", {1.0, 0.1}).outlines.push_back(FakeHost::box(2, 0.01, 0.1, 0.5));
        shells = std::make_unique<Shells>(host);
    }
    static ShellDef dome(double x, double y) {
        ShellDef d;
        d.phi_bar = 0.3;
        d.angle = M_PI;
        d.mu = 0.5;
        d.position = {x, y};
        return d;
    }
    void add(double x, double above = 0.0) { domes.push_back(*shells->create(dome(x, kRise + 1e-6 + above))); }
    void advance(int frames) { test::advance(*shells, host.get(), 1.0 / 60.0, frames); }
    [[nodiscard]] bool asleep(std::size_t i) const { return *shells->asleep(domes[i]); }
    SleepSettings automatic() {
        SleepSettings s;
        s.automatic = true;
        s.delay = 0.2;
        return s;
    }
};

} // namespace

TEST_CASE("shells at rest fall asleep by themselves only if asked to", "[plugin]") {
    for (const bool automatic : {false, true}) {
        Level level;
        if (automatic)
            REQUIRE(level.shells->set_sleep(level.automatic()));
        level.add(0.0);
        level.add(0.0, 0.0009); // one over the other
        level.add(0.2);
        level.advance(90);
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(level.asleep(i) == automatic);
        CHECK(std::abs(level.shells->energy_balance().residual) <
              1e-9 * std::abs(level.shells->energy_balance().added));
    }
}

TEST_CASE("a sleeping island does not move, is not solved, and wakes in equilibrium", "[plugin]") {
    Level level;
    REQUIRE(level.shells->set_sleep(level.automatic()));
    level.add(0.0);
    level.add(0.0, 0.0009);
    level.advance(90);
    REQUIRE(level.asleep(0));
    const step::World before = level.shells->world();
    level.advance(60);
    const step::World& after = level.shells->world();
    CHECK(after.counters.steps == before.counters.steps);
    CHECK(after.counters.gaussSeidelIterations == before.counters.gaussSeidelIterations);
    for (std::size_t i = 0; i < 2; ++i)
        CHECK(after.rods[i].q == before.rods[i].q);
    CHECK(after.energyBalance.friction == before.energyBalance.friction);
    CHECK_FALSE(after.sleepingImpulses.empty());
    REQUIRE(level.shells->wake(level.domes[0]));
    CHECK_FALSE(level.asleep(1)); // the island as a whole
    level.advance(5);
    const step::World& woken = level.shells->world();
    for (std::size_t i = 0; i < 2; ++i) // the forces it fell asleep with hold it: nothing jumps
        CHECK((woken.rods[i].kin.middle() - before.rods[i].kin.middle()).norm() < 1e-3 * 0.0005);
}

TEST_CASE("a sleeping shell wakes when pressed, not when passed", "[plugin]") {
    Level level;
    REQUIRE(level.shells->set_sleep(level.automatic()));
    level.add(0.0);
    level.add(0.1);
    level.advance(60);
    REQUIRE(level.asleep(0));
    REQUIRE(level.asleep(1));
    const ShellHandle falling = *level.shells->create(Level::dome(0.0, 0.03)); // 2 cm above the first
    level.advance(1);
    CHECK(level.asleep(0));
    CHECK_FALSE(*level.shells->asleep(falling));
    bool woken = false;
    for (int i = 0; i < 30 && !woken; ++i) {
        level.advance(1);
        woken = !level.asleep(0);
    }
    CHECK(woken);
    CHECK(level.asleep(1)); // nobody touched that one
    level.advance(120);
    CHECK(*level.shells->asleep(falling)); // and all rest again
    CHECK(level.shells->world().rods[0].island == level.shells->world().rods[2].island);
    CHECK(level.shells->world().counters.penetrationMax < 0.05 * 0.0005);
}

TEST_CASE("calls, gravity and bodies of the host wake", "[plugin]") {
    Level level;
    REQUIRE(level.shells->set_sleep(level.automatic()));
    level.add(0.0);
    level.advance(60);
    const auto sleeps = [&] {
        level.advance(60);
        REQUIRE(level.asleep(0));
    };
    Shells& s = *level.shells;
    const ShellHandle a = level.domes[0];
    const auto wakes = [&](const char* what, bool ok) {
        INFO(what);
        CHECK(ok);
        CHECK_FALSE(level.asleep(0));
        sleeps();
    };
    sleeps();
    wakes("wake", static_cast<bool>(s.wake(a)));
    wakes("apply_force", static_cast<bool>(s.apply_force(a, 0.5, {0.0, -1e-4})));
    wakes("apply_impulse", static_cast<bool>(s.apply_impulse(a, 0.5, {0.0, -1e-7})));
    wakes("set_velocity", static_cast<bool>(s.set_velocity(a, {0.0, 0.0})));
    wakes("set_friction_material", static_cast<bool>(s.set_friction_material(a, 3)));
    wakes("set_friction", static_cast<bool>(s.set_friction(3, 4, 0.5)));
    MaterialDef m;
    m.mu = 0.4;
    wakes("set_material", static_cast<bool>(s.set_material(a, m)));
    wakes("set_filter", static_cast<bool>(s.set_filter(a, {})));
    const HoldHandle pin = *s.create_pin(a, 0.5);
    sleeps(); // held shells sleep too
    wakes("destroy", static_cast<bool>(s.destroy(pin)));
    level.host->g = {0.0, -0.9 * kG};
    level.advance(1);
    CHECK_FALSE(level.asleep(0));
    sleeps();
    level.host->bodies.at(2).state.centre = {0.027, 0.1}; // the door is put beside it
    level.advance(1);
    CHECK_FALSE(level.asleep(0));
    sleeps();
    level.host->bodies.erase(2);
    level.advance(1);
    CHECK_FALSE(level.asleep(0));
    sleeps();
    level.host->bodies.erase(1); // the ground is gone
    level.advance(6);
    CHECK(momentum(s).y() < 0.0);
}

TEST_CASE("a shell that carries a dynamic body stays awake", "[plugin]") {
    Level level;
    REQUIRE(level.shells->set_sleep(level.automatic()));
    level.add(0.0);
    level.host->add(3, "crate", {0.0, kRise + 0.00025 + 0.004 + 1e-5}, 0.0, 0.02)
        .outlines.push_back(FakeHost::box(3, 0.02, 0.004, 0.5));
    for (int i = 0; i < 240 * 2; ++i)
        test::advance(*level.shells, level.host.get(), 1.0 / 240.0, 1);
    CHECK_FALSE(level.asleep(0));
    const Status asked = level.shells->sleep(level.domes[0]);
    CHECK_FALSE(asked);
    CHECK(asked.error().find("dynamic") != std::string::npos);
    CHECK(level.host->bodies.at(3).state.centre.y() > 0.01); // it still stands
}

TEST_CASE("sleep() takes the whole island and its motion", "[plugin]") {
    Level level;
    level.add(0.0);
    level.add(0.2);
    REQUIRE_FALSE(level.shells->sleep(level.domes[0])); // contacts are not known before the first step
    level.advance(10);
    REQUIRE(level.shells->set_velocity(level.domes[1], {0.1, 0.0}));
    REQUIRE_FALSE(level.shells->sleep(level.domes[1])); // nor after a call that changed them
    level.advance(1);
    REQUIRE(level.shells->sleep(level.domes[1]));
    CHECK(level.asleep(1));
    CHECK_FALSE(level.asleep(0));
    CHECK(momentum(*level.shells).x() < 1e-6);
    const Vec2 at = pointAt(*level.shells, 1, 0.5);
    level.advance(30);
    CHECK(pointAt(*level.shells, 1, 0.5) == at);
    CHECK(std::abs(level.shells->energy_balance().residual) < 1e-9 * std::abs(level.shells->energy_balance().added));
}

TEST_CASE("a sleeping shell that moves up in the list is not taken for another one", "[plugin][sleep]") {
    // Equal position, angle and curvature, but ten times as long: data kept of sleeping shells must not be found by
    // these coordinates alone.
    Shells shells(nullptr);
    ShellDef d = strip(0.02, {0.0, 0.0});
    d.mask = 0;
    const ShellHandle shorter = *shells.create(d);
    d = strip(0.2, {0.0, 0.0});
    const ShellHandle longer = *shells.create(d);
    REQUIRE(shells.pre_step(1e-3).failure.empty()); // from then on their contacts are known
    REQUIRE(shells.sleep(shorter));
    REQUIRE(shells.pre_step(1e-3).failure.empty());
    REQUIRE(shells.sleep(longer));
    d = strip(0.02, {0.08, 0.01});
    d.velocity = {0.0, -0.5};
    const ShellHandle bullet = *shells.create(d);
    REQUIRE(shells.pre_step(1e-3).failure.empty());
    REQUIRE(shells.destroy(shorter));
    for (int f = 0; f < 60; ++f)
        REQUIRE(shells.pre_step(1e-3).failure.empty());
    CHECK_FALSE(*shells.asleep(longer)); // hit and awake
    const auto m = shells.state(bullet);
    REQUIRE(m);
    const auto carried = shells.section(longer, 0.9);
    REQUIRE(carried);
    CHECK(m->centre.y > carried->position.y - 1e-3); // it did not fall through
}
