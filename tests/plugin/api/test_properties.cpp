// Changes of existing shells: material, position, velocity, filters, friction of pairs.

#include "tests/plugin/api/support.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// A straight strip on a plane tilted by `angle`.
struct Ramp {
    std::shared_ptr<FakeHost> host = emptyHost(kG);
    std::unique_ptr<Shells> shells;
    ShellHandle strip_;
    double angle;

    explicit Ramp(double tilt, double muGround, double muShell) : angle(tilt) {
        host->addGround(1, muGround, Vec2::Zero(), tilt);
        shells = std::make_unique<Shells>(host);
        ShellDef d = strip(0.05, {}, tilt, 100.0, 3);
        const double up = 0.5 * d.thickness;
        d.position = {-up * std::sin(tilt), up * std::cos(tilt)};
        d.mu = muShell;
        d.friction_material = 7;
        strip_ = *shells->create(d);
    }
    /// Acceleration down the plane over half a second, m/s^2.
    double slide() {
        advance(*shells, host.get(), 0.01, 10);
        const double m = shells->world().rods[0].model.mass();
        const Vec2 down(-std::cos(angle), -std::sin(angle));
        const double before = down.dot(momentum(*shells)) / m;
        advance(*shells, host.get(), 0.01, 50);
        return (down.dot(momentum(*shells)) / m - before) / 0.5;
    }
};

} // namespace

TEST_CASE("friction of a pair decides on a ramp", "[plugin]") {
    const double tilt = std::atan(0.5), g = kG;
    const auto sliding = [&](double mu) { return g * (std::sin(tilt) - mu * std::cos(tilt)); };
    Ramp mean(tilt, 0.4, 0.1); // sqrt: 0.2
    CHECK(mean.slide() == Approx(sliding(0.2)).epsilon(1e-3));
    REQUIRE(mean.shells->set_friction_material(BodyId{1}, 9));
    REQUIRE(mean.shells->set_friction(9, 7, 0.3));
    CHECK(mean.slide() == Approx(sliding(0.3)).epsilon(1e-3));
    REQUIRE(mean.shells->set_friction(7, 9, 0.0)); // the order does not matter
    CHECK(mean.slide() == Approx(sliding(0.0)).epsilon(1e-3));
    REQUIRE(mean.shells->reset_friction(9, 7));
    CHECK(mean.slide() == Approx(sliding(0.2)).epsilon(1e-3));
    CHECK_FALSE(mean.shells->reset_friction(9, 7));
    Ramp stuck(tilt, 0.4, 0.1);
    REQUIRE(stuck.shells->set_friction(7, 9, 0.6));
    REQUIRE(stuck.shells->set_friction_material(BodyId{1}, 9));
    CHECK(std::abs(stuck.slide()) < 1e-6);
    REQUIRE(stuck.shells->set_friction_material(stuck.strip_, 0)); // no particular one
    CHECK(stuck.slide() == Approx(sliding(0.2)).epsilon(1e-3));
}

TEST_CASE("filters and groups decide what collides", "[plugin]") {
    struct Case {
        FilterDef a, b;
        bool meet;
    };
    const FilterDef all{}, none{1, 0, 0}, two{2, 0xffff, 0}, notTwo{1, 0xfffd, 0};
    const auto grouped = [](FilterDef f, std::int16_t group) {
        f.group = group;
        return f;
    };
    const Case cases[] = {{all, all, true},
                          {all, none, false},
                          {two, notTwo, false},
                          {two, two, true},
                          {grouped(all, -3), grouped(all, -3), false},
                          {grouped(all, -3), grouped(all, -4), true},
                          {grouped(none, 5), grouped(none, 5), true},
                          {grouped(none, 5), grouped(all, 6), false}};
    for (const Case& c : cases) {
        INFO("groups " << c.a.group << " and " << c.b.group << ", masks " << c.a.mask << " and " << c.b.mask);
        Shells shells(nullptr);
        const ShellHandle a = *shells.create(strip(0.1, {0.0, 0.0}, 0.0, 100.0, 3));
        ShellDef d = strip(0.1, {0.0, 0.005}, 0.0, 100.0, 3);
        d.velocity = {0.0, -0.1};
        const ShellHandle b = *shells.create(d);
        REQUIRE(shells.set_filter(a, c.a));
        REQUIRE(shells.set_filter(b, c.b));
        CHECK(shells.filter(b)->group == c.b.group);
        advance(shells, nullptr, 0.01, 20);
        CHECK((pointAt(shells, 1, 0.5).y() > pointAt(shells, 0, 0.5).y()) == c.meet);
    }
}

TEST_CASE("groups count against bodies too, and not between a shell and itself", "[plugin]") {
    for (const std::int16_t group : {std::int16_t{0}, std::int16_t{-2}}) {
        auto host = emptyHost(kG);
        host->addGround(1, 0.3);
        host->bodies.at(1).outlines[0].local.group = group;
        Shells shells(host);
        ShellDef d = strip(0.1, {0.0, 0.001}, 0.0, 100.0, 3);
        d.group = group;
        REQUIRE(shells.create(d));
        advance(shells, host.get(), 0.01, 10);
        CHECK((pointAt(shells, 0, 0.5).y() > 0.0) == (group == 0));
    }
    // A nearly closed shell squeezed by its ends keeps them apart, whatever its group.
    Shells shells(nullptr);
    ShellDef d;
    d.phi_bar = 0.97;
    d.group = -1;
    const ShellHandle a = *shells.create(d);
    REQUIRE(shells.create_force(a, 0.0, {0.02, 0.0}));
    REQUIRE(shells.create_force(a, 1.0, {-0.02, 0.0}));
    settle(shells, nullptr, 50);
    CHECK((pointAt(shells, 0, 0.0) - pointAt(shells, 0, 1.0)).norm() > 0.9 * d.thickness);
}

TEST_CASE("a change of material is recorded as added energy", "[plugin]") {
    Shells shells(nullptr);
    ShellDef d = strip(0.1, {0.0, 0.0}, 0.0, 1.0, 10);
    d.velocity = {0.2, 0.0};
    const ShellHandle a = *shells.create(d);
    const double kinetic = shells.energy_balance().kinetic, B = bending_modulus(d);
    MaterialDef m;
    m.density = 2.0 * d.density;
    REQUIRE(shells.set_material(a, m));
    CHECK(shells.energy_balance().kinetic == Approx(2.0 * kinetic).epsilon(1e-12)); // the motion stays
    CHECK(shells.energy_balance().added == Approx(2.0 * kinetic).epsilon(1e-12));
    m = {};
    m.natural_curvature = {20.0};
    REQUIRE(shells.set_material(a, m)); // 1/2 B L kappa0^2 is in it now
    CHECK(shells.energy_balance().bending == Approx(0.5 * B * 0.1 * 400.0).epsilon(1e-12));
    m = {};
    m.young_modulus = 0.5 * d.young_modulus;
    m.mu = 0.7;
    REQUIRE(shells.set_material(a, m));
    CHECK(shells.energy_balance().bending == Approx(0.25 * B * 0.1 * 400.0).epsilon(1e-12));
    CHECK(shells.world().rods[0].mu == 0.7);
    CHECK(std::abs(shells.energy_balance().residual) < 1e-15);
    settle(shells, nullptr, 100);
    const ShellPose pose = *shells.pose(a);
    for (const double k : pose.curvature) // it rolls up to its new shape
        CHECK(k == Approx(20.0).epsilon(1e-6));
    CHECK(momentum(shells).x() == Approx(2.0 * massOf(d) * 0.2).epsilon(1e-9));
    CHECK(std::abs(shells.energy_balance().residual) < 1e-9 * shells.energy_balance().added);
}

TEST_CASE("a teleported shell keeps shape and velocity in its own frame", "[plugin]") {
    auto host = emptyHost(kG);
    Shells shells(host);
    ShellDef d;
    d.velocity = {0.3, 0.1};
    d.spin = 2.0;
    const ShellHandle a = *shells.create(d);
    advance(shells, host.get(), 0.01, 3);
    const EnergyBalance before = shells.energy_balance();
    const ShellPose shape = *shells.pose(a);
    const Vec2 was = momentum(shells);
    const double angle = shells.world().rods[0].q[shells.world().rods[0].model.dofTheta()];
    REQUIRE(shells.teleport(a, {1.0, 2.0}, angle + 0.5 * M_PI));
    CHECK((pointAt(shells, 0, 0.5) - Vec2(1.0, 2.0)).norm() < 1e-14);
    CHECK((momentum(shells) - Vec2(-was.y(), was.x())).norm() < 1e-10 * was.norm());
    CHECK(shells.pose(a)->curvature == shape.curvature);
    const EnergyBalance after = shells.energy_balance();
    CHECK(after.kinetic == Approx(before.kinetic).epsilon(1e-10));
    CHECK(after.added - before.added ==
          Approx(after.gravity - before.gravity + after.kinetic - before.kinetic).epsilon(1e-9));
    CHECK(std::abs(after.residual) < 1e-12 * std::abs(after.added));
    REQUIRE(shells.set_velocity(a, {0.0, 0.0}));
    CHECK(shells.energy_balance().kinetic == Approx(0.0).margin(1e-18));
    CHECK(std::abs(shells.energy_balance().residual) < 1e-12 * std::abs(after.added));
    const HoldHandle pin = *shells.create_pin(a, 0.5);
    CHECK_FALSE(shells.teleport(a, {0.0, 0.0}, 0.0)); // held
    REQUIRE(shells.destroy(pin));
    CHECK(shells.teleport(a, {0.0, 0.0}, 0.0));
}

TEST_CASE("overlapping shells separate slowly", "[plugin]") {
    Shells shells(nullptr);
    const ShellDef d = strip(0.1, {0.0, 0.0}, 0.0, 100.0, 4);
    REQUIRE(shells.create(d));
    ShellDef other = d;
    other.position.y = 0.2 * d.thickness; // 80 % of the thickness inside
    REQUIRE(shells.create(other));
    advance(shells, nullptr, 1.0 / 60.0, 12); // parting takes 40 ms
    CHECK(pointAt(shells, 1, 0.5).y() - pointAt(shells, 0, 0.5).y() > 0.99 * d.thickness);
    // they part at 20 thicknesses a second, and the last 4 % in one step: some 10 thicknesses / s each
    CHECK(shells.energy_balance().kinetic < 2.0 * massOf(d) * std::pow(20.0 * d.thickness, 2));
    CHECK(std::abs(shells.energy_balance().residual) < 1e-9 * std::abs(shells.energy_balance().position_correction));
}
