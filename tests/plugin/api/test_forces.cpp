// Forces, torques, impulses and mouse joints against closed forms.

#include "tests/plugin/api/support.h"

using namespace supercircle;
using namespace supercircle::test;

TEST_CASE("a tip force bends a cantilever as beam theory says", "[plugin]") {
    Shells shells(nullptr);
    const ShellDef d = strip(0.1, {0.05, 0.0}, 0.0, 1.0, 20);
    const ShellHandle a = *shells.create(d);
    REQUIRE(shells.create_clamp(a, 0.0));
    const double B = bending_modulus(d), F = 0.003 * B / (0.1 * 0.1);
    const ForceHandle force = *shells.create_force(a, 1.0, {0.0, F});
    settle(shells, nullptr, 100);
    // F L^3 / 3B; ends make 20 arcs too soft by 5 / (48 N^3) = 1.3e-5, slope .0015 makes geometry good to 1e-6.
    const double exact = F * 1e-3 / (3.0 * B);
    CHECK(pointAt(shells, 0, 1.0).y() == Approx(exact).epsilon(2e-5));
    REQUIRE(shells.set_force(force, {0.0, -F}));
    settle(shells, nullptr, 100);
    CHECK(pointAt(shells, 0, 1.0).y() == Approx(-exact).epsilon(2e-5));
    REQUIRE(shells.destroy(force));
    CHECK_FALSE(shells.valid(force));
    settle(shells, nullptr, 100);
    CHECK(std::abs(pointAt(shells, 0, 1.0).y()) < 1e-8 * exact);
    CHECK(std::abs(shells.energy_balance().residual) < 1e-12 * F * exact + 1e-18);
}

TEST_CASE("a torque at the tip bends the strip to a circle", "[plugin]") {
    Shells shells(nullptr);
    const ShellDef d = strip(0.1, {0.05, 0.0}, 0.0, 1.0, 6);
    const ShellHandle a = *shells.create(d);
    const HoldHandle clamp = *shells.create_clamp(a, 0.0);
    const double B = bending_modulus(d), T = B * M_PI / 0.1; // half a circle
    REQUIRE(shells.create_force(a, 1.0, {}, T));
    settle(shells, nullptr, 300);
    const ShellPose pose = *shells.pose(a);
    for (const double k : pose.curvature)
        CHECK(k == Approx(M_PI / 0.1).epsilon(1e-9)); // pure bending is exact for arcs
    CHECK(shells.reaction(clamp)->torque == Approx(-T).epsilon(1e-9));
    // quasi-statically half the torque's work is stored; the steps were long, so the rest went into damping
    const EnergyBalance b = shells.energy_balance();
    CHECK(b.bending == Approx(0.5 * T * M_PI).epsilon(1e-8));
    CHECK(b.work == Approx(T * M_PI).epsilon(0.01)); // the clamp works too: on the third-order gaps of so long steps
    CHECK(std::abs(b.residual) < 1e-10 * b.work);
}

TEST_CASE("a force for one frame gives its impulse and ends", "[plugin]") {
    Shells shells(nullptr);
    const ShellDef d = strip(0.1, {0.0, 0.0});
    const ShellHandle a = *shells.create(d);
    REQUIRE(shells.apply_force(a, 0.3, {0.02, 0.01}));
    REQUIRE(shells.apply_force(a, 0.9, {0.0, 0.01})); // they add up
    advance(shells, nullptr, 0.01, 1);
    const Vec2 gained = momentum(shells);
    CHECK(gained.x() == Approx(0.02 * 0.01).epsilon(1e-12));
    CHECK(gained.y() == Approx(0.02 * 0.01).epsilon(1e-12));
    advance(shells, nullptr, 0.01, 5);
    CHECK((momentum(shells) - gained).norm() < 1e-12 * gained.norm());
    REQUIRE(shells.apply_torque(a, 0.5, 1e-5));
    const double before = angularMomentum(shells);
    advance(shells, nullptr, 0.001, 1);
    // first order in the step within the frame: the shell turns a little under its torque
    CHECK(angularMomentum(shells) - before == Approx(1e-5 * 0.001).epsilon(1e-3));
    CHECK(std::abs(shells.energy_balance().residual) < 1e-10 * shells.energy_balance().work);
}

TEST_CASE("an impulse anywhere on a bent shell is its change of momentum and angular momentum", "[plugin]") {
    for (const double fraction : {0.0, 0.37, 0.5, 1.0}) {
        Shells shells(nullptr);
        ShellDef d;
        d.position = {0.3, -0.2};
        d.angle = 0.7;
        const ShellHandle a = *shells.create(d);
        const Vec2 p(3e-4, -2e-4);
        const Vec2 at = pointAt(shells, 0, fraction);
        REQUIRE(shells.apply_impulse(a, fraction, {p.x(), p.y()}, 1e-7));
        CHECK((momentum(shells) - p).norm() < 1e-11 * p.norm());
        const double l = rod::cross(at, p) + 1e-7;
        CHECK(angularMomentum(shells) == Approx(l).epsilon(1e-9));
        const EnergyBalance b = shells.energy_balance();
        CHECK(b.work == b.kinetic); // all it did is motion
        CHECK(b.kinetic > 0.5 * p.squaredNorm() / shells.world().rods[0].model.mass());
        advance(shells, nullptr, 4e-3, 20);
        CHECK((momentum(shells) - p).norm() < 1e-10 * p.norm());
        CHECK(std::abs(shells.energy_balance().residual) < 1e-9 * b.work);
    }
}

TEST_CASE("a mouse joint holds a shell where force and weight balance", "[plugin]") {
    auto host = emptyHost(kG);
    Shells shells(host);
    const ShellDef d = strip(0.1, {0.0, 0.0}, 0.0, 10.0);
    const double weight = massOf(d) * kG;
    const ShellHandle a = *shells.create(d);
    MouseJointDef g;
    g.arc_fraction = 0.5;
    g.target = {0.01, 0.02};
    g.frequency = 3.0;
    const MouseJointHandle joint = *shells.create_mouse_joint(a, g);
    advance(shells, host.get(), 1.0 / 60.0, 240);
    const double k = massOf(d) * std::pow(2.0 * M_PI * 3.0, 2);
    const Vec2 at = pointAt(shells, 0, 0.5);
    // what still swings after 4 s of 7 / s damping is below 1e-6 of the stretch
    CHECK(at.x() == Approx(0.01).margin(1e-6));
    CHECK(at.y() == Approx(0.02 - weight / k).margin(1e-6));
    CHECK(shells.reaction(joint)->force.y == Approx(weight).epsilon(1e-5));
    CHECK(std::abs(shells.energy_balance().residual) < 1e-9 * weight * 0.1);
    REQUIRE(shells.set_target(joint, {0.03, 0.02}));
    advance(shells, host.get(), 1.0 / 60.0, 240);
    CHECK(pointAt(shells, 0, 0.5).x() == Approx(0.03).margin(1e-6));
    REQUIRE(shells.destroy(joint));
    CHECK_FALSE(shells.valid(joint));
    advance(shells, host.get(), 1.0 / 60.0, 6);
    CHECK(momentum(shells).y() == Approx(-weight * 0.1).epsilon(1e-3)); // it falls
}

TEST_CASE("a mouse joint has its frequency and damping", "[plugin]") {
    Shells shells(nullptr);
    const ShellHandle a = *shells.create(strip(0.02, {0.01, 0.0}, 0.0, 1.0, 3));
    MouseJointDef g;
    g.frequency = 1.0;
    g.damping_ratio = 0.1;
    REQUIRE(shells.create_mouse_joint(a, g));
    shells.stepper().settings().fixedDt = 1e-4;
    advance(shells, nullptr, 1.0, 1);
    // x = a exp(-zeta w t) (cos wd t + ...), after one second with w = 2 pi; backward Euler adds w^2 dt / 2 to the
    // damping, 2e-3, which is 0.2 % of the amplitude
    const double w = 2.0 * M_PI, wd = w * std::sqrt(0.99), zeta = 0.1;
    const double x = 0.01 * std::exp(-zeta * w) * (std::cos(wd) + zeta * w / wd * std::sin(wd));
    CHECK(pointAt(shells, 0, 0.5).x() == Approx(x).epsilon(0.005));
}

TEST_CASE("a mouse joint pulls with at most its largest force", "[plugin]") {
    auto host = emptyHost(kG);
    Shells shells(host);
    const ShellDef d = strip(0.1, {0.0, 0.0});
    const double weight = massOf(d) * kG;
    const ShellHandle a = *shells.create(d);
    MouseJointDef g;
    g.target = {0.0, 1.0};
    g.frequency = 20.0;
    g.max_force = 0.5 * weight;
    const MouseJointHandle joint = *shells.create_mouse_joint(a, g);
    double most = 0.0;
    advance(shells, host.get(), 1.0 / 60.0, 30, [&] {
        most = std::max(most, std::hypot(shells.reaction(joint)->force.x, shells.reaction(joint)->force.y));
        return false;
    });
    CHECK(most < 1.011 * g.max_force);                                        // 1 % is what a step accepts
    CHECK(momentum(shells).y() == Approx(-0.5 * weight * 0.5).epsilon(0.01)); // falls with half of g for half a second
}
