// Pins, welds, tethers and driven holds against closed forms.

#include "tests/plugin/api/support.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

JointDef between(JointKind kind, ShellHandle a, double fa, ShellHandle b, double fb) {
    JointDef j;
    j.kind = kind;
    j.shell = a;
    j.arc_fraction = fa;
    j.other = b;
    j.other_fraction = fb;
    return j;
}

JointDef toBody(JointKind kind, ShellHandle a, double fa, BodyId body) {
    JointDef j;
    j.kind = kind;
    j.shell = a;
    j.arc_fraction = fa;
    j.body = body;
    return j;
}

} // namespace

TEST_CASE("a driven clamp is at its target at the end of every frame", "[plugin]") {
    Shells shells(nullptr);
    const ShellHandle a = *shells.create(ShellDef{});
    const HoldHandle clamp = *shells.create_clamp(a, 0.3);
    const TargetDef from = *shells.target(clamp);
    const auto path = [&](double t) {
        TargetDef d;
        d.position = {from.position.x + 0.02 * std::sin(3.0 * t), from.position.y + 0.01 * t * t};
        d.velocity = {0.06 * std::cos(3.0 * t), 0.02 * t};
        d.angle = from.angle + 2.0 * t;
        d.spin = 2.0;
        return d;
    };
    double between = 0.0;
    for (int i = 1; i <= 60; ++i) {
        const double t = i / 60.0;
        REQUIRE(shells.set_target(clamp, path(t)));
        advance(shells, nullptr, 1.0 / 60.0, 1, [&] {
            const TargetDef asked = *shells.target(clamp);
            between = i == 1 ? 0.0
                             : std::max(between, // the first frame starts from rest
                                        std::hypot(asked.position.x - path(shells.time()).position.x,
                                                   asked.position.y - path(shells.time()).position.y));
            return false;
        });
        const TargetDef now = *shells.target(clamp);
        CHECK(now.position.x == path(t).position.x); // bitwise
        CHECK(now.angle == path(t).angle);
        CHECK((pointAt(shells, 0, 0.3) - Vec2(now.position.x, now.position.y)).norm() < 2e-7);
        CHECK(angleAt(shells, 0, 0.3) == Approx(path(t).angle).epsilon(1e-9));
    }
    CHECK(between < 1e-9);            // a cubic through a sine: a w^4 dt^4 / 384 = 3e-10 m
    advance(shells, nullptr, 0.1, 1); // without a new target: straight on
    CHECK(shells.target(clamp)->position.y == Approx(path(1.0).position.y + 0.1 * 0.02).epsilon(1e-12));
    CHECK(std::abs(shells.energy_balance().residual) < 1e-9 * std::abs(shells.energy_balance().work));
}

TEST_CASE("a tethered shell is a pendulum whose string never gets longer", "[plugin]") {
    auto host = emptyHost(kG);
    Shells shells(host);
    // A straight strip tied at its middle: its centre of mass swings as a point does, whatever it does itself.
    const double theta = 0.5, L = 0.5;
    const ShellHandle a = *shells.create(strip(0.02, {L * std::sin(theta), -L * std::cos(theta)}, 0.3, 1.0, 3));
    JointDef j;
    j.kind = JointKind::Tether;
    j.shell = a;
    const JointHandle string = *shells.create_joint(j);
    CHECK(*shells.length(string) == Approx(L).epsilon(1e-14));
    shells.stepper().settings().dtMax = 1e-3;
    double longest = 0.0, before = 1.0, time = 0.0;
    std::vector<double> zeros;
    advance(shells, host.get(), 1.0 / 60.0, 240, [&] {
        const Vec2 p = pointAt(shells, 0, 0.5);
        longest = std::max(longest, p.norm() - L);
        if (before > 0.0 && p.x() <= 0.0)
            zeros.push_back(time + (shells.time() - time) * before / (before - p.x()));
        before = p.x();
        time = shells.time();
        return false;
    });
    CHECK(longest < 1e-6 * L);
    REQUIRE(zeros.size() == 3);
    // Period 2 pi sqrt(L/g) (1 + theta^2/16 + 11 theta^4/3072 + 173 theta^6/737280); steps of 1 ms are wrong by
    // (w dt)^2 / 6 = 3e-6 of it.
    const double T0 = 2.0 * M_PI * std::sqrt(L / kG), T = (zeros[2] - zeros[0]) / 2.0;
    const double period =
        T0 * (1.0 + theta * theta / 16.0 + 11.0 * std::pow(theta, 4) / 3072.0 + 173.0 * std::pow(theta, 6) / 737280.0);
    CHECK(T == Approx(period).epsilon(1e-5));
    const EnergyBalance b = shells.energy_balance();
    CHECK(std::abs(b.work) < 1e-9 * massOf(strip(0.02, {})) * kG * L); // the string does no work
    CHECK(std::abs(b.position_correction) < 1e-5 * massOf(strip(0.02, {})) * kG * L);
    CHECK(b.kinetic + b.bending + b.gravity <= b.added);
    CHECK(std::abs(b.residual) < 1e-9 * massOf(strip(0.02, {})) * kG * L);
}

TEST_CASE("a slack tether does nothing, and a taut one carries the weight", "[plugin]") {
    auto host = emptyHost(kG);
    Shells shells(host);
    const ShellDef d = strip(0.05, {0.0, 0.0}, M_PI / 2.0, 1.0, 4);
    const ShellHandle a = *shells.create(d);
    JointDef j;
    j.kind = JointKind::Tether;
    j.shell = a;
    j.arc_fraction = 1.0; // the upper end
    j.point = {0.0, 0.125};
    j.length = 0.2;
    const JointHandle string = *shells.create_joint(j);
    advance(shells, host.get(), 0.01, 13);                                           // 8.3 cm of fall: not yet taut
    CHECK(centreOf(shells, 0).y() == Approx(-0.5 * kG * 0.13 * 0.13).epsilon(0.02)); // first order in the step
    CHECK(shells.reaction(string)->force.y == 0.0);
    settle(shells, host.get(), 100);
    CHECK(shells.reaction(string)->force.y == Approx(massOf(d) * kG).epsilon(1e-6));
    CHECK(pointAt(shells, 0, 1.0).y() == Approx(0.125 - 0.2).margin(1e-7));
    REQUIRE(shells.set_max_length(string, 0.1, 0.05)); // two seconds
    advance(shells, host.get(), 0.01, 300);
    CHECK(*shells.length(string) == 0.1);
    CHECK(pointAt(shells, 0, 1.0).y() == Approx(0.125 - 0.1).margin(1e-6));
    // the tether lifted it by 10 cm: this is the work, apart from losses of falling and starting
    CHECK(shells.energy_balance().work == Approx(massOf(d) * kG * 0.1).epsilon(0.01));
    REQUIRE(shells.set_target(string, {{0.05, 0.125}, 0.0, {}, 0.0}));
    advance(shells, host.get(), 0.01, 400);
    CHECK((pointAt(shells, 0, 1.0) - Vec2(0.05, 0.125)).norm() < 0.1 + 1e-7);
    REQUIRE(shells.destroy(string));
    const double before = momentum(shells).y();
    advance(shells, host.get(), 0.01, 10);
    CHECK(momentum(shells).y() - before == Approx(-massOf(d) * kG * 0.1).epsilon(1e-9)); // it falls
}

TEST_CASE("two strips welded end to end are one strip", "[plugin]") {
    // The weld of two half strips against one strip of twice the elements, each clamped at its root under a tip force.
    const ShellDef whole = strip(0.1, {0.05, 0.0}, 0.0, 1.0, 16);
    const double F = 0.8 * bending_modulus(whole) / (0.1 * 0.1); // large deflection
    Shells one(nullptr), two(nullptr);
    const ShellHandle w = *one.create(whole);
    REQUIRE(one.create_clamp(w, 0.0));
    REQUIRE(one.create_force(w, 1.0, {0.0, F}));
    settle(one, nullptr, 200);
    const ShellHandle a = *two.create(strip(0.05, {0.025, 0.0}, 0.0, 1.0, 8));
    const ShellHandle b = *two.create(strip(0.05, {0.075, 0.0}, 0.0, 1.0, 8));
    REQUIRE(two.create_clamp(a, 0.0));
    const JointHandle weld = *two.create_joint(between(JointKind::Weld, a, 1.0, b, 0.0));
    REQUIRE(two.create_force(b, 1.0, {0.0, F}));
    settle(two, nullptr, 200);
    // Within 5 / (48 N^3), 8 elements each: elements at a weld count as those at ends do.
    CHECK((pointAt(two, 1, 1.0) - pointAt(one, 0, 1.0)).norm() < 2e-5 * 0.1);
    CHECK((pointAt(two, 0, 1.0) - pointAt(two, 1, 0.0)).norm() < 1e-9);
    CHECK(angleAt(two, 0, 1.0) == Approx(angleAt(two, 1, 0.0)).margin(1e-8));
    // on the first half: force and moment of what is beyond
    const Vec2 arm = pointAt(two, 1, 1.0) - pointAt(two, 1, 0.0);
    CHECK(two.reaction(weld)->force.y == Approx(F).epsilon(1e-6));
    CHECK(std::abs(two.reaction(weld)->force.x) < 1e-6 * F);
    CHECK(two.reaction(weld)->torque == Approx(arm.x() * F).epsilon(1e-6));
    CHECK(std::abs(two.energy_balance().residual) < 1e-9 * two.energy_balance().work);
}

TEST_CASE("a weld to a wall carries weight and moment", "[plugin]") {
    auto host = emptyHost(kG);
    host->add(1, "wall", {-0.5, 0.0}, 0.3).outlines.push_back(FakeHost::box(1, 0.1, 0.1, 0.3));
    Shells shells(host);
    const ShellDef d = strip(0.1, {0.05, 0.0});
    const ShellHandle a = *shells.create(d);
    const JointHandle weld = *shells.create_joint(toBody(JointKind::Weld, a, 0.0, 1));
    settle(shells, host.get(), 200);
    const double weight = massOf(d) * kG;
    CHECK(shells.reaction(weld)->force.y == Approx(weight).epsilon(1e-6));
    CHECK(shells.reaction(weld)->torque == Approx(weight * centreOf(shells, 0).x()).epsilon(1e-6));
    CHECK(pointAt(shells, 0, 0.0).norm() < 1e-9);
    CHECK(std::abs(angleAt(shells, 0, 0.0)) < 1e-9);
    host->bodies.erase(1); // the wall goes, and its joints with it
    advance(shells, host.get(), 0.01, 10);
    CHECK_FALSE(shells.valid(weld));
    CHECK(momentum(shells).y() == Approx(-weight * 0.1).epsilon(0.05));
}

TEST_CASE("a chain of pinned shells swings without gaining energy or length", "[plugin]") {
    auto host = emptyHost(kG);
    Shells shells(host);
    std::vector<ShellHandle> links;
    for (int i = 0; i < 5; ++i)
        links.push_back(*shells.create(strip(0.05, {0.025 + 0.05 * i, 0.0}, 0.0, 100.0, 3)));
    REQUIRE(shells.create_pin(links[0], 0.0));
    for (std::size_t i = 1; i < links.size(); ++i)
        REQUIRE(shells.create_joint(between(JointKind::Pin, links[i - 1], 1.0, links[i], 0.0)));
    double gap = 0.0, most = -1.0, lowest = 0.0;
    const double scale = 5 * massOf(strip(0.05, {})) * kG * 0.125;
    advance(shells, host.get(), 1.0 / 60.0, 50, [&] { // until the links hit each other
        for (std::size_t i = 1; i < 5; ++i)
            gap = std::max(gap, (pointAt(shells, i - 1, 1.0) - pointAt(shells, i, 0.0)).norm());
        lowest = std::min(lowest, pointAt(shells, 4, 1.0).y());
        const EnergyBalance b = shells.energy_balance();
        most = std::max(most, (b.kinetic + b.bending + b.gravity - b.added) / scale);
        return false;
    });
    CHECK(gap < 1e-7);
    CHECK(most < 1e-6);
    CHECK(lowest < -0.2); // it did swing
    const EnergyBalance b = shells.energy_balance();
    CHECK(std::abs(b.work) < 1e-5 * scale); // pins and joints do no work, but for the gaps they close
    CHECK(std::abs(b.position_correction) < 1e-4 * scale);
    CHECK(std::abs(b.residual) < 1e-9 * scale);
    CHECK(shells.world().counters.unconverged == 0);
}

TEST_CASE("a shell joined to a body exchanges momentum with it exactly", "[plugin]") {
    for (const JointKind kind : {JointKind::Pin, JointKind::Weld, JointKind::Tether}) {
        INFO("kind " << static_cast<int>(kind));
        auto host = emptyHost();
        host->add(1, "puck", {0.03, 0.06}, 0.2, 0.002, 1e-6).outlines.push_back(FakeHost::box(1, 0.01, 0.01, 0.3));
        Shells shells(host);
        const ShellHandle a = *shells.create(strip(0.1, {0.0, 0.0}));
        JointDef j = toBody(kind, a, 1.0, *shells.body("puck"));
        j.point = {0.03, 0.05};
        const JointHandle joint = *shells.create_joint(j);
        REQUIRE(shells.apply_impulse(a, 0.2, {-2e-4, -3e-4}));
        const Vec2 before = momentum(shells);
        const double turning = angularMomentum(shells);
        const double length = kind == JointKind::Tether ? *shells.length(joint) : 0.0;
        double stretch = -1.0;
        for (int i = 0; i < 60; ++i) {
            advance(shells, host.get(), 4e-3, 1);
            const step::BodyState& s = host->bodies.at(1).state;
            const step::Link& l = shells.world().links[0];
            const double c = std::cos(s.angle), n = std::sin(s.angle);
            const Vec2 tied = s.centre + Vec2(c * l.local.x() - n * l.local.y(), n * l.local.x() + c * l.local.y());
            stretch = std::max(stretch, (pointAt(shells, 0, 1.0) - tied).norm() - length);
        }
        const step::BodyState& s = host->bodies.at(1).state;
        const Vec2 after = momentum(shells) + 0.002 * s.velocity;
        CHECK(s.velocity.norm() > 0.01);
        CHECK((after - before).norm() < 1e-10 * before.norm());
        const double turns = angularMomentum(shells) + 0.002 * rod::cross(s.centre, s.velocity) + 1e-6 * s.spin;
        CHECK(turns == Approx(turning).epsilon(0.05)); // first order in the step
        CHECK(stretch < 1e-6);
        CHECK(std::abs(shells.energy_balance().residual) < 1e-9 * shells.energy_balance().work);
    }
}

TEST_CASE("a joined pair does not collide unless asked to", "[plugin]") {
    for (const bool collide : {false, true}) {
        Shells shells(nullptr);
        const ShellHandle a = *shells.create(strip(0.1, {0.0, 0.0}));
        const ShellHandle b = *shells.create(strip(0.1, {0.0, 0.02}, 0.1));
        JointDef j = between(JointKind::Pin, a, 0.0, b, 0.0);
        j.collide_connected = collide;
        REQUIRE(shells.create_joint(j));
        // press the upper one through the lower one
        REQUIRE(shells.create_force(a, 1.0, {0.0, 1e-3}));
        REQUIRE(shells.create_force(b, 1.0, {0.0, -1e-3}));
        advance(shells, nullptr, 4e-3, 50);
        CHECK((pointAt(shells, 1, 1.0).y() > pointAt(shells, 0, 1.0).y()) == collide);
    }
}
