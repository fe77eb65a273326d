// Two-way coupling with rigid bodies of the host.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

struct Standing {
    double force = 0.0;   ///< mean force on the crate over the last half second over its weight
    double scatter = 0.0; ///< largest deviation from that mean over the weight
    double gap = 0.0;     ///< largest distance from touching in that time over h
    double speed = 0.0;   ///< of the crate at the end, m/s
};

/// A crate put on a half-circle dome, with host frames of `dt`.
Standing stand(double mass, double inertia, double dt) {
    FakeHost host;
    host.g = {0.0, -kG};
    host.addGround(1, 0.5);
    step::World w;
    const rod::RodDefinition d = paperShell(0.5);
    const double h = d.thickness;
    put(w, d, {0.0, kR + 0.5 * h}, M_PI, 0.5);
    host.add(2, "crate", {0.0, kR + h + 0.004 + 1e-4}, 0.0, mass, inertia)
        .outlines.push_back(FakeHost::box(2, 0.02, 0.004, 0.5));
    step::Stepper s({});
    const int frames = static_cast<int>(2.0 / dt), last = static_cast<int>(0.5 / dt);
    Standing out;
    double weight = mass * kG, low = 1e9, high = -1e9;
    for (int i = 0; i < frames; ++i) {
        frame(s, w, host, dt);
        if (i < frames - last)
            continue;
        const step::Body& crate =
            *std::find_if(w.bodies.begin(), w.bodies.end(), [](const auto& b) { return b.id == 2; });
        const double f = crate.impulse.y() / dt / weight; // over the frame
        out.force += f / last;
        low = std::min(low, f);
        high = std::max(high, f);
        double top = 0.0;
        for (int k = 0; k <= 200; ++k)
            top = std::max(top, w.rods[0].kin.point(rod::locate(w.rods[0].model, d.length * k / 200.0)).y());
        const step::BodyState& b = host.bodies.at(2).state;
        out.gap = std::max(out.gap, std::abs(b.centre.y() - 0.004 - (top + 0.5 * h)) / h);
    }
    out.scatter = std::max(high - out.force, out.force - low);
    out.speed = host.bodies.at(2).state.velocity.norm();
    CHECK(w.counters.unconverged == 0);
    return out;
}

/// A host whose body 2 is held by a brake: rigid rows in x, y and angle that give way beyond a force.
class BrakedHost : public FakeHost {
public:
    double strength = 0.0; ///< N, along x and y
    double torque = 0.0;   ///< N m
    void constraints(const std::vector<step::BodyId>&, double, step::HostConstraints& out) const override {
        const Vec2 axes[] = {Vec2::UnitX(), Vec2::UnitY(), Vec2::Zero()};
        for (int i = 0; i < 3; ++i) {
            step::HostRow r;
            r.b = 2;
            r.axisB = axes[i];
            r.turnB = i == 2 ? 1.0 : 0.0;
            r.strength = i == 2 ? torque : strength;
            out.rows.push_back(r);
        }
    }
};

const step::Body& bodyTwo(const step::World& w) {
    return w.bodies[static_cast<std::size_t>(step::bodyIndex(w, 2))];
}

} // namespace

TEST_CASE("a step that is given up leaves the host's brakes as they were", "[step]") {
    BrakedHost host;
    host.strength = 1e-3;
    host.torque = 1e-5;
    host.add(2, "puck", {0.08, 0.0}, 0.0, 0.01, 1e-6).outlines.push_back(FakeHost::box(2, 0.01, 0.03, 0.35));
    step::World w;
    put(w, paperShell(), {0.0, 0.0}, 1.0, 0.35, {0.4, 0.0});
    step::Stepper s({});
    bool touched = false, gaveWay = false;
    std::uint64_t before = 0;
    const step::FrameResult out = s.advance(w, 0.2, &host, [&](const step::World& now) {
        touched |= !now.impulses.empty();
        if (!touched) {
            CHECK(bodyTwo(now).state.velocity.norm() < 1e-9); // a brake that had given way would move it: 1e-4 m/s
            for (const step::HostRow& r : now.constraints.rows)
                CHECK(r.saturated == 0);
            before = now.counters.rejected;
        }
        for (const step::HostRow& r : now.constraints.rows)
            gaveWay |= r.saturated != 0;
        return false;
    });
    REQUIRE(out.failure.empty());
    CHECK(before > 0); // blows that came too early in steps that were too long
    CHECK(touched);
    CHECK(gaveWay);
    CHECK(bodyTwo(w).state.velocity.x() > 1e-3);
}

TEST_CASE("a joint stays closed while the brake of its body gives way and grips again", "[step]") {
    BrakedHost host;
    host.g = {0.0, -kG};
    const rod::RodDefinition d = paperShell();
    const double weight = d.linearMass * d.length * kG;
    host.strength = 2.0 * weight;
    host.torque = 1.0;
    host.add(2, "hub", {0.0, 0.0}, 0.0, 1e-3, 1e-7).state.gravityScale = 0.0;
    step::World w;
    put(w, d, {0.0, 0.0}, 1.2, 0.35, Vec2::Zero(), 12.0);
    step::Link pin;
    pin.key = 1;
    pin.end = step::LinkEnd::Body;
    pin.rodA = w.rods[0].key;
    pin.sA = 0.5 * d.length;
    pin.body = 2;
    w.links.push_back(pin);
    step::Stepper s({});
    int slips = 0, holds = 0;
    double apart = 0.0;
    std::uint64_t steps = 0;
    const step::FrameResult out = s.advance(w, 1.0, &host, [&](const step::World& now) {
        const step::BodyState& b = bodyTwo(now).state;
        apart = std::max(apart, (now.rods[0].kin.middle() - b.centre).norm());
        ++(b.velocity.norm() > 1e-4 ? slips : holds);
        ++steps;
        return false;
    });
    REQUIRE(out.failure.empty());
    CAPTURE(slips, holds, apart);
    CHECK(slips > 20);
    CHECK(holds > 20);
    CHECK(apart < 1e-6 * d.thickness * 10.0); // joints close to 1e-7 of an element, 6e-10 m
    CHECK(w.counters.solves > steps);         // each turn of a linearisation counts
}

TEST_CASE("a crate stands on a shell: its weight, and no gap", "[step]") {
    for (const double mass : {0.01, 0.02}) // 26 and 52 times the half circle's 0.38 g
        for (const double inertia : {0.0, mass * (0.04 * 0.04 + 0.008 * 0.008) / 12.0}) {
            INFO("mass " << mass << " kg, inertia " << inertia);
            const Standing s = stand(mass, inertia, 1.0 / 240.0);
            CAPTURE(s.force, s.scatter, s.gap, s.speed);
            CHECK(s.force == Approx(1.0).epsilon(1e-3)); // at rest; what swings on averages out
            CHECK(s.scatter < 0.01);
            CHECK(s.gap < 0.01);
            CHECK(s.speed < 1e-3);
        }
}

TEST_CASE("a light crate and long frames", "[step]") {
    const double cases[][2] = {{0.001, 1.0 / 240.0}, {0.005, 1.0 / 240.0}, {0.01, 1.0 / 60.0}};
    for (const auto& c : cases)
        for (const double inertia : {0.0, c[0] * (0.04 * 0.04 + 0.008 * 0.008) / 12.0}) {
            INFO("mass " << c[0] << " kg, frame " << c[1] << " s, inertia " << inertia);
            const Standing s = stand(c[0], inertia, c[1]);
            CAPTURE(s.force, s.scatter, s.gap, s.speed);
            CHECK(s.force == Approx(1.0).epsilon(1e-3));
            CHECK(s.gap < 0.01);
            CHECK(s.speed < 1e-3);
        }
}

TEST_CASE("shell and body exchange momentum exactly", "[step]") {
    FakeHost host;
    host.add(1, "puck", {0.05, 0.003}, 0.2, 0.002, 1e-7).outlines.push_back(FakeHost::box(1, 0.01, 0.01, 0.35));
    step::World w;
    put(w, paperShell(), {0.0, 0.0}, 1.0, 0.35, {0.4, 0.0}, 2.0);
    step::Stepper s({});
    const auto total = [&] { return Vec2(momentum(w) + 0.002 * host.bodies.at(1).state.velocity); };
    const Vec2 before = total();
    for (int i = 0; i < 60; ++i)
        frame(s, w, host, 4e-3);
    CHECK(host.bodies.at(1).state.velocity.norm() > 0.01); // it was hit
    CHECK((total() - before).norm() < 1e-11 * before.norm());
    CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * w.energyBalance.added);
}

TEST_CASE("a kinematic plate does exactly the work that the energy balance records", "[step]") {
    FakeHost host;
    host.addGround(1, 0.35);
    step::World w;
    const rod::RodDefinition d = paperShell(0.5);
    put(w, d, {0.0, kR + 0.5 * d.thickness}, M_PI, 0.35);
    host.add(2, "plate", {0.0, kR + d.thickness + 0.01 + 1e-6}).outlines.push_back(FakeHost::box(2, 0.05, 0.01, 0.35));
    w.crossheadBodies.push_back(2);
    w.crossheadVelocity = {0.0, -0.01};
    step::Stepper s({});
    double work = 0.0, travelled = 0.0;
    for (int i = 0; i < 100; ++i)
        frame(s, w, host, 4e-3, [&](const step::World& now) {
            work += -now.crossheadForce().y() * (now.crossheadTravel.y() - travelled);
            travelled = now.crossheadTravel.y();
            return false;
        });
    CHECK(work > 0.0);
    CHECK(w.energyBalance.work == Approx(work).epsilon(1e-9)); // force times travel, step by step
    CHECK(host.bodies.at(2).state.centre.y() == Approx(kR + d.thickness + 0.01 + 1e-6 - 0.004).epsilon(1e-12));
}
