// What must hold whatever happens: energy, momentum, determinism, restoring, survival of bad numbers.

#include "tests/supercircle/step/setup.h"

#include <limits>

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Shells about to fall into a pile between two walls.
void makePile(step::World& w, FakeHost& host, int count) {
    host.g = {0.0, -kG};
    host.addGround(1, 0.35);
    host.add(2, "left", {-0.17, 0.5}).outlines.push_back(FakeHost::box(2, 0.1, 0.5, 0.35));
    host.add(3, "right", {0.17, 0.5}).outlines.push_back(FakeHost::box(3, 0.1, 0.5, 0.35));
    for (int i = 0; i < count; ++i)
        put(w, paperShell(), {(i % 2 == 0 ? -0.03 : 0.03), 0.05 + 0.042 * (i / 2)}, 0.9 * i, 0.35);
}

} // namespace

TEST_CASE("a shell dropped on the floor never gains energy", "[step]") {
    for (const double angle : {0.0, 0.6, 2.5, M_PI}) {
        INFO("angle " << angle);
        FakeHost host;
        host.g = {0.0, -kG};
        host.addGround(1, 0.35);
        step::World w;
        w.gravity = host.g;
        put(w, paperShell(), {0.0, 0.06}, angle, 0.35, {0.2, 0.0}, 5.0);
        step::Stepper s({});
        double last = w.energyBalance.stored(), gain = 0.0;
        const double scale = w.rods[0].model.mass() * kG * 0.06;
        for (int i = 0; i < 125; ++i)
            frame(s, w, host, 4e-3, [&](const step::World& now) {
                gain = std::max(gain, now.energyBalance.stored() - last);
                last = now.energyBalance.stored();
                return false;
            });
        CAPTURE(gain / scale, w.energyBalance.positionCorrection / scale);
        // overlap (below 0.006 h, see Settings::relinearise) pushed out by the weight: m g 3 um against m g 60 mm
        CHECK(gain < 5e-5 * scale);
        CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * scale);
        CHECK(w.energyBalance.friction >= 0.0);
        CHECK(w.counters.penetrationMax < 0.04 * 5e-4);
        CHECK(w.counters.unconverged == 0);
    }
}

TEST_CASE("the impact of a stiff stick on its tip loses the closed-form energy", "[step]") {
    // Plastic and frictionless at one end of a uniform stick at angle a to the floor: effective mass
    // m / (1 + 3 cos^2 a), loss m_eff v^2 / 2 (the vertical normal acts at L/2 cos(a) from the centre).
    for (const double a : {0.3, 0.8, 1.3}) {
        INFO("angle " << a);
        FakeHost host;
        host.addGround(1, 0.0);
        step::World w;
        const rod::RodDefinition d = strip(0.002, 1e4); // tiny and stiff: its modes are far faster than a step
        put(w, d, {0.0, 0.5 * d.thickness + 0.001 * std::sin(a) + 1e-4}, a, 0.0, {0.0, -0.1});
        step::Stepper s({});
        for (int i = 0; i < 6; ++i) // touches after 1 ms; not long enough to come down on the other end
            frame(s, w, host, 2.5e-4);
        const double m = w.rods[0].model.mass();
        const double loss = 0.5 * m * 0.01 / (1.0 + 3.0 * std::cos(a) * std::cos(a));
        CAPTURE(w.energyBalance.impact / loss, w.energyBalance.numerical / loss,
                w.energyBalance.positionCorrection / loss, w.time);
        CHECK((w.energyBalance.added - w.energyBalance.stored()) / loss == Approx(1.0).epsilon(0.01));
        CHECK(w.energyBalance.impact / loss ==
              Approx(1.0).epsilon(0.02)); // the rest is the closing of the speculative gap
        CHECK(std::abs(w.energyBalance.residual()) < 1e-12 * loss + 1e-18);
    }
}

TEST_CASE("a stiff ring that falls flat loses all its energy in the impact", "[step]") {
    FakeHost host;
    host.addGround(1, 0.35);
    step::World w;
    const rod::RodDefinition d = ring(0.002, 1e4);
    put(w, d, {0.0, 0.5 * d.thickness + 1e-4}, 0.0, 0.35, {0.0, -0.1});
    step::Stepper s({});
    for (int i = 0; i < 8; ++i)
        frame(s, w, host, 2.5e-4);
    const double before = w.energyBalance.added;
    CAPTURE(w.energyBalance.impact / before, w.energyBalance.numerical / before,
            w.energyBalance.positionCorrection / before);
    CHECK(w.energyBalance.stored() < 1e-3 * before); // what the ring keeps by its slight give
    CHECK(w.energyBalance.impact / before == Approx(1.0).epsilon(0.02));
}

TEST_CASE("two shells that collide in free space keep their momentum", "[step]") {
    step::World w;
    put(w, paperShell(), {-0.03, 0.0}, 0.5, 0.35, {0.5, 0.02}, 3.0);
    put(w, paperShell(), {0.03, 0.012}, 2.0, 0.35, {-0.3, 0.0}, -2.0);
    const Vec2 before = momentum(w);
    const double scale = w.rods[0].model.mass() * 0.5, kinetic = w.energyBalance.kinetic;
    step::Stepper s({});
    for (int i = 0; i < 100; ++i)
        REQUIRE(s.advance(w, 2e-3, nullptr, {}).failure.empty());
    CHECK(w.energyBalance.impact + w.energyBalance.friction > 0.01 * kinetic); // they did meet
    CHECK((momentum(w) - before).norm() < 1e-11 * scale);                      // round-off of a few thousand steps
    CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * kinetic);
    CHECK(w.counters.unconverged == 0);
}

TEST_CASE("the same digits from any number of threads", "[step]") {
    std::vector<step::World> results;
    for (const int threads : {1, 2, 4, 1}) {
        FakeHost host;
        step::World w;
        makePile(w, host, 10);
        step::Settings settings;
        settings.threads = threads;
        step::Stepper s(settings);
        for (int i = 0; i < 60; ++i)
            frame(s, w, host, 4e-3);
        CHECK(!w.impulses.empty());
        results.push_back(std::move(w));
    }
    for (std::size_t i = 1; i < results.size(); ++i)
        CHECK(sameState(results[0], results[i]));
}

TEST_CASE("a saved world replays to the same digits", "[step]") {
    FakeHost host; // nothing but static bodies: copying the world copies all that changes
    step::World w;
    makePile(w, host, 4);
    step::Stepper s({});
    for (int i = 0; i < 40; ++i)
        frame(s, w, host, 4e-3);
    const step::World saved = w;
    for (int i = 0; i < 30; ++i)
        frame(s, w, host, 4e-3);
    const step::World first = w;
    w = saved;
    for (int i = 0; i < 30; ++i)
        frame(s, w, host, 4e-3);
    CHECK(sameState(first, w));
    w = saved;
    step::Stepper fresh({}); // nothing of the state hides in the stepper
    for (int i = 0; i < 30; ++i)
        frame(fresh, w, host, 4e-3);
    CHECK(sameState(first, w));
}

namespace {

void spoil(bool inPosition, int victims) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, inf}) {
        INFO(bad << (inPosition ? " in q" : " in v") << ", " << victims << " shells");
        FakeHost host;
        host.g = {0.0, -kG};
        host.addGround(1, 0.35);
        step::World w, alone;
        put(alone, paperShell(), {0.2, 0.05}, 0.3, 0.35);
        for (int i = 0; i < victims; ++i)
            put(w, paperShell(), {-0.2 * i, 0.05}, 0.3, 0.35);
        put(w, paperShell(), {0.2, 0.05}, 0.3, 0.35);
        for (int i = 0; i < victims; ++i)
            (inPosition ? w.rods[static_cast<std::size_t>(i)].q : w.rods[static_cast<std::size_t>(i)].v)[2] = bad;
        step::Settings settings;
        settings.fixedDt = 1e-3;
        step::Stepper s(settings), other(settings);
        bool fine = true;
        for (int i = 0; i < 100 && fine; ++i) {
            const step::FrameResult out = s.advance(w, 1e-3, &host, {});
            INFO(out.failure);
            CHECK((fine = out.failure.empty()));
            frame(other, alone, host, 1e-3);
        }
        for (int i = 0; i < victims; ++i)
            CHECK(w.rods[static_cast<std::size_t>(i)].quarantined);
        const step::Rod& healthy = w.rods.back();
        CHECK_FALSE(healthy.quarantined);
        CHECK((healthy.q - alone.rods[0].q).norm() < 1e-12 * alone.rods[0].q.norm());
        CHECK(std::isfinite(w.energyBalance.kinetic));
    }
}

} // namespace

TEST_CASE("a shell with bad velocities is set aside and the others go on", "[step]") {
    spoil(false, 1);
}
TEST_CASE("several shells with bad velocities in one frame", "[step]") {
    spoil(false, 2);
}
TEST_CASE("a shell with a bad configuration", "[step]") {
    spoil(true, 1);
}

TEST_CASE("a nonsensical frame is refused and changes nothing", "[step]") {
    step::World w;
    put(w, paperShell(), {0.0, 0.0}, 0.0, 0.35, {1.0, 0.0});
    step::Stepper s({});
    const Eigen::VectorXd q = w.rods[0].q;
    for (const double dt :
         {0.0, -1e-3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const step::FrameResult out = s.advance(w, dt, nullptr, {});
        CHECK_FALSE(out.failure.empty());
        CHECK(out.advanced == 0.0);
        CHECK(sameBits(w.rods[0].q, q));
        CHECK(w.time == 0.0);
    }
}

TEST_CASE("a fixed step takes exactly the steps asked for", "[step]") {
    FakeHost host;
    step::World w;
    makePile(w, host, 3);
    step::Settings settings;
    settings.fixedDt = 5e-4;
    step::Stepper s(settings);
    for (int i = 0; i < 400; ++i) {
        frame(s, w, host, 5e-4);
        REQUIRE(w.counters.steps == static_cast<std::uint64_t>(i) + 1 + w.counters.rejected * 0);
    }
    CHECK(w.time == Approx(0.2).epsilon(1e-12));
    CHECK(w.counters.unconverged == 0);
    CHECK(w.counters.penetrationMax < 0.25 * 5e-4); // beyond that even a fixed step is redone smaller
    CHECK(std::abs(w.energyBalance.residual()) < 1e-9 * std::abs(w.energyBalance.added));
}

TEST_CASE("the observer can stop a frame, and the rest of it is not lost", "[step]") {
    step::World w;
    w.gravity = {0.0, -kG};
    put(w, paperShell(), {0.0, 0.0}, 0.0, 0.35);
    step::Stepper s({});
    const step::FrameResult out = s.advance(w, 0.1, nullptr, [](const step::World& now) { return now.time > 0.02; });
    CHECK(out.stopped);
    CHECK(out.advanced == w.time);
    CHECK(out.advanced > 0.02);
    CHECK(out.advanced < 0.1);
}
