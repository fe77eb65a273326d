// Islands step by themselves: what happens in one changes no bit of another, and those that meet are one.

#include "tests/supercircle/step/setup.h"

#include <functional>

namespace supercircle::test {

namespace {

struct Scene {
    FakeHost host;
    step::World world;
    step::Stepper stepper{step::Settings{}};

    Scene() {
        host.g = {0.0, -kG};
        host.addGround(1, 0.4);
        stepper.settings().crossingCheck = true;
    }
    void advance(int frames, double dt, const std::function<void(int)>& disturb = {}) {
        for (int i = 0; i < frames; ++i) {
            if (disturb)
                disturb(i);
            frame(stepper, world, host, dt);
        }
    }
};

/// Two shells that fall onto each other, and a crate that falls onto both.
void addNear(Scene& s) {
    put(s.world, paperShell(), {0.0, 0.04}, M_PI, 0.4);
    put(s.world, paperShell(), {0.004, 0.09}, M_PI, 0.4, {0.0, -0.5});
    FakeHost::Body& crate = s.host.add(2, "crate", {0.0, 0.2}, 0.1, 0.02, 2e-6);
    crate.outlines.push_back(FakeHost::box(2, 0.02, 0.01, 0.4));
}

/// Shells far away, with bodies and joints of their own.
void addFar(Scene& s) {
    put(s.world, paperShell(0.6, 9), {30.0, 0.03}, M_PI, 0.4, {0.0, -2.0}, 20.0);
    put(s.world, strip(0.1, 0.2), {30.05, 0.08}, 0.3, 0.4);
    step::Link pin;
    pin.key = s.world.nextPart++;
    pin.rodA = s.world.rods[s.world.rods.size() - 1].key;
    pin.end = step::LinkEnd::World;
    pin.target.point = s.world.rods.back().kin.node(0);
    s.world.links.push_back(pin);
    FakeHost::Body& crate = s.host.add(9, "far crate", {30.0, 0.3}, 0.0, 0.02, 2e-6);
    crate.outlines.push_back(FakeHost::box(9, 0.02, 0.01, 0.4));
}

void requireSameBits(const Scene& a, const Scene& b, std::size_t rods) {
    for (std::size_t i = 0; i < rods; ++i) {
        REQUIRE(sameBits(a.world.rods[i].q, b.world.rods[i].q));
        REQUIRE(sameBits(a.world.rods[i].v, b.world.rods[i].v));
    }
    REQUIRE(a.host.bodies.at(2).state.centre == b.host.bodies.at(2).state.centre);
    REQUIRE(a.host.bodies.at(2).state.velocity == b.host.bodies.at(2).state.velocity);
    REQUIRE(a.host.bodies.at(2).state.angle == b.host.bodies.at(2).state.angle);
}

} // namespace

TEST_CASE("a far island changes no bit of the others", "[step][islands]") {
    Scene alone, crowded;
    addNear(alone);
    addNear(crowded);
    addFar(crowded);
    const auto disturb = [&](int i) {
        if (i % 7 == 3) // never towards the others: shells that may meet within a frame are one island
            step::applyImpulse(crowded.world, 2, 0.01, {0.002 * (i % 3), 0.004}, 0.0);
        if (i == 40) // another shell, in no way of anybody
            put(crowded.world, paperShell(0.5, 7), {-40.0, 0.1}, 1.0, 0.4);
        if (i == 60)
            step::removeRod(crowded.world, 2);
    };
    for (int i = 0; i < 100; ++i) {
        alone.advance(1, 1.0 / 60.0);
        disturb(i);
        crowded.advance(1, 1.0 / 60.0);
        requireSameBits(alone, crowded, 2);
    }
}

TEST_CASE("islands keep the energy balance and the momentum of the whole", "[step][islands]") {
    // Without gravity and floor momentum is constant; the balance closes to rounding whatever the number of islands.
    Scene s;
    s.host.g.setZero();
    s.host.bodies.clear();
    for (int i = 0; i < 6; ++i)
        put(s.world, paperShell(0.6, 9), {0.3 * i, 0.02 * (i % 2)}, 0.4 * i, 0.4, {i % 2 ? -0.6 : 0.9, 0.05 * i},
            3.0 * i);
    const Vec2 before = momentum(s.world);
    double scale = 0.0;
    for (const step::Rod& r : s.world.rods)
        scale += r.model.mass() * r.speed;
    s.advance(120, 1.0 / 60.0); // they come from islands of one to meetings of several, and part again
    CHECK((momentum(s.world) - before).norm() < 1e-9 * scale);
    const step::EnergyBalance& e = s.world.energyBalance;
    CHECK(std::abs(e.residual()) < 1e-9 * e.added);
    CHECK(e.impact > 0.0);
    CHECK(s.world.counters.crossings == 0);
}

TEST_CASE("an island that leaves its reach joins the one it comes near to", "[step][islands]") {
    // At rest at the start of the frame, a hand throws the shell 0.5 m far within it: its reach was a hand's breadth.
    for (const double force : {5.0, 50.0, 500.0}) {
        Scene s;
        s.host.g.setZero();
        s.host.bodies.clear();
        const std::size_t thrown = put(s.world, paperShell(0.6, 9), {0.0, 0.0}, M_PI / 2.0, 0.4);
        put(s.world, strip(0.4, 400.0, 9), {0.3, 0.0}, M_PI / 2.0, 0.4);
        const double mass = s.world.rods[thrown].model.mass();
        step::AppliedForce hand;
        hand.s = s.world.rods[thrown].model.midS();
        hand.force = {force * mass / 0.002, 0.0};
        s.world.rods[thrown].forces.push_back(hand);
        const double time = std::sqrt(2.0 * 0.5 / (hand.force.x() / mass));
        s.advance(1, time);
        CAPTURE(force);
        // It stays on its side: the strip is pushed along, not passed.
        const double front = centre(s.world.rods[1]).x();
        for (int i = 0; i <= s.world.rods[thrown].model.elements(); ++i)
            CHECK(s.world.rods[thrown].kin.node(i).x() < front + 0.2);
        CHECK(centre(s.world.rods[1]).x() > 0.3);
        CHECK(s.world.counters.crossings == 0);
        const double gained = hand.force.x() * time;
        CHECK(momentum(s.world).x() == Approx(gained).epsilon(1e-9)); // nothing else pushes
    }
}

TEST_CASE("sleepers far from what moves take no steps, and wake when something comes", "[step][islands]") {
    Scene s;
    s.stepper.settings().autoSleep = true;
    put(s.world, paperShell(), {0.0, 0.0384 + 0.0003}, M_PI, 0.4);
    for (int i = 0; i < 400 && !s.world.rods[0].asleep(); ++i)
        s.advance(1, 1.0 / 60.0);
    REQUIRE(s.world.rods[0].asleep());
    const std::uint64_t steps = s.world.counters.steps;
    s.advance(5, 1.0 / 60.0);
    CHECK(s.world.counters.steps == steps);
    CHECK(s.world.time > 5.0 / 60.0);
    put(s.world, paperShell(), {0.002, 0.3}, M_PI, 0.4);
    for (int i = 0; i < 60 && s.world.rods[0].asleep(); ++i)
        s.advance(1, 1.0 / 60.0);
    CHECK_FALSE(s.world.rods[0].asleep());
    CHECK(s.world.counters.crossings == 0);
}

TEST_CASE("a thin ribbon beside thick shells does not set their steps", "[step][islands]") {
    // Thick shells drop onto each other while a ribbon of a twentieth of their thickness lies within reach: their
    // limits are their own. The bound is the price that a still neighbour may have.
    const auto stepsOf = [](bool ribbon) {
        Scene s;
        rod::RodDefinition thick = paperShell(0.6, 9);
        thick.thickness = 0.002;
        put(s.world, thick, {0.0, 0.0384 + 0.0012}, M_PI, 0.4);
        put(s.world, thick, {0.002, 0.07}, M_PI, 0.4);
        if (ribbon) {
            rod::RodDefinition thin = strip(0.05, 1.0, 5);
            thin.thickness = 0.0001;
            put(s.world, thin, {0.05, 0.00005}, 0.0, 0.4);
        }
        s.advance(60, 1.0 / 60.0);
        CHECK(s.world.counters.crossings == 0);
        return static_cast<double>(s.world.counters.steps);
    };
    CHECK(stepsOf(true) <= 1.3 * stepsOf(false));
}

TEST_CASE("an observer sees all shells at one time", "[step][islands]") {
    Scene s;
    addNear(s);
    addFar(s);
    double last = 0.0;
    bool whole = true, rising = true;
    step::FrameResult out = s.stepper.advance(s.world, 1.0 / 60.0, &s.host, [&](const step::World& w) {
        whole = whole && &w == &s.world && w.rods.size() == 4;
        rising = rising && w.time > last;
        last = w.time;
        return false;
    });
    CHECK(out.failure.empty());
    CHECK(whole);
    CHECK(rising);
}

TEST_CASE("strips thicker than their arcs are long meet in one island") {
    // Arcs of 1 mm, centre lines 4 mm apart: the surfaces touch, while nodes and arcs are far from each other.
    Scene s;
    s.host.g.setZero();
    rod::RodDefinition d = strip(0.05, 100.0, 50);
    d.thickness = 0.004;
    put(s.world, d, {0.0, 0.5}, 0.0, 0.4);
    put(s.world, d, {0.0, 0.5 + d.thickness + 1e-6}, 0.0, 0.4, {0.0, -0.05});
    const double momentum = s.world.rods[1].model.mass() * 0.05;
    s.advance(24, 1.0 / 240.0); // 5 mm, if nothing is met
    CHECK(s.world.counters.penetrationMax < s.stepper.settings().rejectPenetration * d.thickness);
    CHECK(s.world.rods[1].kin.node(25).y() - s.world.rods[0].kin.node(25).y() > 0.98 * d.thickness);
    double after = 0.0;
    for (const step::Rod& r : s.world.rods)
        for (std::size_t g = 0; g < r.u.size(); ++g)
            after -= r.gauss.mass[g] * r.u[g].y();
    CHECK(after == Approx(momentum).epsilon(1e-9)); // round-off of some hundred steps
}

} // namespace supercircle::test
