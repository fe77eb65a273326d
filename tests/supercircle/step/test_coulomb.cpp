// Coulomb's law through the whole step: sticking, sliding, sliding that turns into rolling.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

/// Displacement along an incline (downhill positive) after `time` of a stiff strip lying on it, m.
double slideOnIncline(double angle, double mu, double time, step::World& w) {
    FakeHost host;
    host.g = {0.0, -kG};
    host.addGround(1, mu, Vec2::Zero(), angle);
    const rod::RodDefinition d = strip(0.02, 1e3);
    const Vec2 up(-std::sin(angle), std::cos(angle)), downhill(-std::cos(angle), -std::sin(angle));
    put(w, d, 0.5 * d.thickness * up, angle, mu);
    step::Stepper s({});
    const Vec2 start = centre(w.rods[0]);
    const int frames = static_cast<int>(std::lround(time / 4e-3));
    for (int i = 0; i < frames; ++i)
        frame(s, w, host, 4e-3);
    return downhill.dot(centre(w.rods[0]) - start);
}

} // namespace

TEST_CASE("a strip on an incline sticks below tan(angle) = mu and slides above", "[step]") {
    const double time = 0.4;
    for (const double mu : {0.1, 0.35, 0.7})
        for (const double ratio : {0.9, 0.99, 1.01, 1.2, 2.0}) {
            const double angle = std::atan(ratio * mu);
            INFO("mu " << mu << ", tan(angle) / mu " << ratio);
            step::World w;
            const double x = slideOnIncline(angle, mu, time, w);
            if (ratio < 1.0) {
                // 1 nm: what the contact tolerance of 1e-8 leaves in 100 steps
                CHECK(std::abs(x) < 1e-9);
            } else {
                const double a = kG * (std::sin(angle) - mu * std::cos(angle));
                // implicit Euler runs ahead by a t dt / 2, dt <= 4 ms: 1 % of a t^2 / 2; never behind
                CHECK(x / (0.5 * a * time * time) > 1.0 - 1e-4);
                CHECK(x / (0.5 * a * time * time) < 1.0 + 0.0101);
                // friction of the energy balance: mu m g cos(angle) x; the same sum over steps, so only solver
                // tolerance remains
                const double heat = mu * w.rods[0].model.mass() * kG * std::cos(angle) * x;
                CHECK(w.energyBalance.friction == Approx(heat).epsilon(1e-3));
            }
            CHECK(w.counters.unconverged == 0);
        }
}

TEST_CASE("a ring that starts sliding ends rolling", "[step]") {
    // Mass on the centre line (I = m R^2), friction at the surface r = R + h/2. With beta = (r / R)^2:
    // t* = v0 / (mu g (1 + beta)), v = v0 beta / (1 + beta), x* = v0 t* - mu g t*^2 / 2 (beta = 1: 0.375 v0^2 / (mu
    // g)).
    const double radius = 0.01, v0 = 0.2;
    for (const double mu : {0.1, 0.35}) {
        INFO("mu " << mu);
        FakeHost host;
        host.g = {0.0, -kG};
        host.addGround(1, mu);
        step::World w;
        const rod::RodDefinition d = ring(radius, 1e4);
        const double r = radius + 0.5 * d.thickness, beta = (r / radius) * (r / radius);
        // the middle of a closed rod that runs counter-clockwise from the top is at the bottom
        put(w, d, {0.0, 0.5 * d.thickness}, 0.0, mu, {v0, 0.0});
        step::Settings settings;
        settings.dtMax = 1.25e-4;
        step::Stepper s(settings);
        const double tRoll = v0 / (mu * kG * (1.0 + beta)), xRoll = v0 * tRoll - 0.5 * mu * kG * tRoll * tRoll;
        const double vRoll = v0 * beta / (1.0 + beta);
        double t = 0.0, last = 0.0;
        const double x0 = centre(w.rods[0]).x();
        double slidTo = 0.0; // where friction did its last work
        while (t < 1.5 * tRoll) {
            frame(s, w, host, 1e-3, [&](const step::World& now) {
                if (now.energyBalance.friction - last > 1e-9 * now.energyBalance.added)
                    slidTo = centre(now.rods[0]).x() - x0;
                last = now.energyBalance.friction;
                return false;
            });
            t = w.time;
        }
        const double v = momentum(w).x() / w.rods[0].model.mass();
        CAPTURE(slidTo, xRoll, v, vRoll, w.energyBalance.numerical / w.energyBalance.friction);
        CHECK(slidTo == Approx(xRoll).epsilon(0.01)); // a few steps of 0.125 ms out of t* >= 29 ms
        CHECK(v == Approx(vRoll).epsilon(0.002));     // the impulse balance does not depend on dt; the ring's give does
        CHECK(w.energyBalance.friction == Approx(0.5 * w.rods[0].model.mass() * (v0 * v0 - v0 * vRoll)).epsilon(0.01));
        CHECK(w.counters.unconverged == 0);
    }
}

TEST_CASE("a ring rolls down an incline with half the acceleration of a sliding block", "[step]") {
    const double radius = 0.01, angle = 0.3, mu = 0.35; // tan(0.3) = 0.31 < 2 mu: it rolls (T8)
    FakeHost host;
    host.g = {0.0, -kG};
    host.addGround(1, mu, Vec2::Zero(), angle);
    step::World w;
    const rod::RodDefinition d = ring(radius, 1e4);
    const double beta = std::pow(1.0 + 0.5 * d.thickness / radius, 2);
    const Vec2 up(-std::sin(angle), std::cos(angle)), downhill(-std::cos(angle), -std::sin(angle));
    put(w, d, 0.5 * d.thickness * up, angle, mu);
    step::Settings settings;
    settings.dtMax = 1e-3;
    step::Stepper s(settings);
    const Vec2 start = centre(w.rods[0]);
    for (int i = 0; i < 100; ++i)
        frame(s, w, host, 2e-3);
    // a = g sin(angle) / (1 + (R / r)^2); implicit Euler is dt / t = 0.5 % ahead
    const double a = kG * std::sin(angle) / (1.0 + 1.0 / beta);
    const double x = downhill.dot(centre(w.rods[0]) - start);
    CHECK(x / (0.5 * a * 0.04) == Approx(1.0).epsilon(0.006));
    CHECK(w.energyBalance.friction < 1e-3 * w.energyBalance.kinetic); // rolling costs nothing
    CHECK(w.counters.unconverged == 0);
}
