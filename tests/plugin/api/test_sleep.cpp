// Islands at rest sleep, take no time, and wake when they should.

#include "tests/plugin/api/support.h"

#include <functional>

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

namespace {

/// A dome with a crate on it.
struct Carrier : Level {
    Carrier() {
        REQUIRE(shells->set_sleep(automatic()));
        add(0.0);
        host->add(3, "crate", {0.0, kRise + 0.00025 + 0.004 + 1e-5}, 0.0, 0.02, 2e-6)
            .outlines.push_back(FakeHost::box(3, 0.02, 0.004, 0.5));
    }
    [[nodiscard]] FakeHost::Body& crate() const { return host->bodies.at(3); }
    void sleep() {
        for (int i = 0; i < 240 * 4 && !asleep(0); ++i)
            frame();
        REQUIRE(asleep(0));
        REQUIRE_FALSE(crate().state.awake);
    }
    void frame() { test::advance(*shells, host.get(), 1.0 / 240.0, 1); }
};

} // namespace

TEST_CASE("a shell that carries a dynamic body sleeps with it", "[plugin][sleep]") {
    Carrier level;
    for (int i = 0; i < 24; ++i)
        level.frame();
    const Status asked = level.shells->sleep(level.domes[0]); // by a call: only without bodies
    CHECK_FALSE(asked);
    CHECK(asked.error().find("dynamic") != std::string::npos);
    level.sleep();
    const Vec2 place = level.crate().state.centre;
    const std::uint64_t steps = level.shells->world().counters.steps;
    for (int i = 0; i < 240; ++i)
        level.frame();
    CHECK(level.crate().state.centre == place);
    CHECK(level.shells->world().counters.steps == steps);
    REQUIRE(level.shells->wake(level.domes[0]));
    for (int i = 0; i < 24; ++i) {
        level.frame();
        CHECK((level.crate().state.centre - place).norm() < 1e-3 * 0.0005);
    }
    CHECK(level.crate().state.awake);
    CHECK(level.asleep(0) == false);
}

TEST_CASE("what happens to a sleeping crate wakes its shell before the step", "[plugin][sleep]") {
    Carrier level;
    const auto wakes = [&](const char* what, const std::function<void(step::BodyState&)>& hand) {
        INFO(what);
        level.sleep();
        hand(level.crate().state);
        level.frame();
        CHECK_FALSE(level.asleep(0));
        CHECK(level.crate().state.awake);
    };
    wakes("the host wakes it", [](step::BodyState& s) { s.awake = true; });
    wakes("it is given a velocity", [](step::BodyState& s) { s.velocity = {0.0, 0.02}; });
    wakes("it is moved", [](step::BodyState& s) { s.centre.y() += 1e-4; });
    wakes("it gets heavier", [](step::BodyState& s) { s.mass *= 1.5; });
    wakes("it may not sleep", [](step::BodyState& s) { s.maySleep = false; });
    for (int i = 0; i < 240; ++i)
        level.frame();
    CHECK_FALSE(level.asleep(0));
    level.crate().state.maySleep = true;
    level.sleep();
    level.host->bodies.erase(3);
    level.frame();
    CHECK_FALSE(level.asleep(0));
}

TEST_CASE("a hold that drives a shell into a sleeping crate pushes it", "[plugin][sleep]") {
    Carrier level;
    level.sleep();
    ShellDef d = strip(0.02, {0.06, 0.012});
    const ShellHandle hand = *level.shells->create(d);
    const HoldHandle hold = *level.shells->create_clamp(hand, 0.5);
    TargetDef target;
    target.position = {0.06, 0.012};
    target.angle = level.shells->target(hold)->angle;
    target.velocity = {-0.1, 0.0};
    for (int i = 0; i < 84; ++i) { // 35 mm: the last 5 with the crate
        REQUIRE(level.shells->set_target(hold, target));
        level.frame();
        target.position.x += target.velocity.x / 240.0;
    }
    CHECK(level.shells->world().counters.crossings == 0);
    CHECK(level.crate().state.centre.x() < -0.004);
}

TEST_CASE("a host that takes a crate for resting does not stop it while its shell moves", "[plugin][sleep]") {
    // The hand sinks by 10 mm/s; the host puts the crate to sleep in every third of its steps.
    Level level;
    const ShellHandle carrier = *level.shells->create(strip(0.04, {0.0, 0.1}, 0.0, 1e4));
    const HoldHandle hold = *level.shells->create_clamp(carrier, 0.5);
    level.host->add(3, "crate", {0.0, 0.1 + 0.00025 + 0.004}, 0.0, 0.02, 2e-6)
        .outlines.push_back(FakeHost::box(3, 0.01, 0.004, 0.5));
    TargetDef target;
    target.position = {0.0, 0.1};
    target.velocity = {0.0, -0.01};
    const double before = level.host->bodies.at(3).state.centre.y();
    for (int i = 0; i < 240; ++i) {
        REQUIRE(level.shells->set_target(hold, target));
        const FrameReport r = level.shells->pre_step(1.0 / 240.0);
        REQUIRE(r.failure.empty());
        level.host->step(r.advanced);
        if (i % 3 == 0)
            level.host->setAwake(3, false);
        REQUIRE(level.shells->post_step());
        target.position.y += target.velocity.y / 240.0;
        if (i > 24) {
            CHECK(level.host->bodies.at(3).state.awake);
            CHECK(level.host->bodies.at(3).state.velocity.y() == Approx(-0.01).epsilon(0.02));
        }
    }
    CHECK(level.host->bodies.at(3).state.centre.y() - before == Approx(-0.01).epsilon(0.01));
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
