// A minute of what shells do: one bounces and slides in a box that rocks, one is snapped through by a ball that comes
// and goes. The balance of energy closes, and the scheme brings in nothing.

#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

namespace {

constexpr double kRockingFrame = 1.0 / 60.0; ///< s
constexpr step::BodyId kBox = 1, kBall = 2;

rod::RodDefinition shellOf(double radius, double angle, double thickness, int elements) {
    rod::RodDefinition d;
    d.length = radius * angle;
    d.thickness = thickness;
    d.linearMass = 1.0;
    d.bendingModulus = 0.5;
    d.naturalCurvature.assign(static_cast<std::size_t>(elements), -1.0 / radius); // opens downwards
    return d;
}

step::BodyOutline blockAt(const Vec2& centre, double halfWidth, double halfHeight, std::uint32_t key) {
    step::BodyOutline o = FakeHost::box(kBox, halfWidth, halfHeight, 0.3, key);
    for (Vec2& p : o.local.points)
        p += centre;
    return o;
}

struct Minute {
    FakeHost host;
    step::World w;
    double snapped = 0.0; ///< largest part of an arch's bending energy that a frame released
    double most = 0.0;    ///< bending energy of the arch, J
    int bounces = 0;

    Minute() {
        w.gravity = host.g = {0.0, -kG};
        FakeHost::Body& box = host.add(kBox, "box", {0.0, 0.5});
        box.kinematic = true;
        box.state.moving = true;
        box.outlines = {blockAt({0.0, -0.6}, 1.2, 0.1, 0), blockAt({-1.1, 0.0}, 0.1, 0.5, 1),
                        blockAt({1.1, 0.0}, 0.1, 0.5, 2), blockAt({0.0, 0.6}, 1.2, 0.1, 3)};
        put(w, shellOf(0.15, 1.5 * M_PI, 0.01, 15), {0.0, 0.75}, 0.2, 0.3, {1.0, 0.0}, 3.0);

        const double radius = 0.5, half = 0.25 * M_PI;
        put(w, shellOf(radius, 2.0 * half, 0.01, 16), {10.0, 1.0}, 0.0, 0.3);
        step::Rod& arch = w.rods[1];
        for (const double s : {0.0, arch.model.definition().length}) {
            step::Hold h;
            h.s = s;
            const rod::MaterialPoint at = rod::locate(arch.model, s);
            h.target.point = arch.kin.point(at);
            h.target.angle = arch.kin.angle(at);
            arch.holds.push_back(h);
        }
        step::BodyOutline ball;
        ball.local.kind = contact::OutlineKind::Circle;
        ball.local.points = {Vec2::Zero()};
        ball.local.radius = 0.05;
        ball.body = kBall;
        ball.friction = 0.3;
        FakeHost::Body& pusher = host.add(kBall, "ball", {10.02, 1.2});
        pusher.kinematic = true;
        pusher.state.moving = true;
        pusher.outlines.push_back(ball);
    }

    void frame(step::Stepper& stepper) {
        const double t = w.time;
        host.bodies.at(kBox).state.spin = 0.5 * M_PI * 0.5 * std::cos(0.5 * M_PI * t);   // half a radian each way
        host.bodies.at(kBall).state.velocity = {0.0, -0.26 * M_PI * std::sin(M_PI * t)}; // 0.52 m down in a second
        const double before = rod::bendingEnergy(w.rods[1].model, w.rods[1].q), impact = w.energyBalance.impact;
        test::frame(stepper, w, host, kRockingFrame);
        const double now = rod::bendingEnergy(w.rods[1].model, w.rods[1].q);
        most = std::max(most, now);
        snapped = std::max(snapped, (before - now) / std::max(most, 1e-9));
        bounces += w.energyBalance.impact > impact + 1e-3 ? 1 : 0;
    }

    void play(double time, bool game) {
        CAPTURE(game);
        step::Stepper stepper(game ? step::gameSettings() : step::Settings{});
        while (w.time < time)
            frame(stepper);
        const step::EnergyBalance& e = w.energyBalance;
        const double turnover = std::abs(e.work) + e.friction + e.impact + e.damping + std::abs(e.toBodies);
        CHECK(std::abs(e.residual()) < (game ? 1e-6 : 1e-9) * turnover);
        CHECK(e.numerical > -1e-6 * turnover); // it takes, here and there it gives what the alarm allows
        CHECK(e.friction > 0.0);
        CHECK(bounces > static_cast<int>(time / 4.0)); // one a swing of the box
        CHECK(snapped > 0.3);                          // in a frame: a snap
        for (const step::Rod& r : w.rods)
            CHECK_FALSE(r.quarantined);
    }
};

} // namespace

TEST_CASE("bouncing, sliding and snapping shells keep the balance of energy", "[step]") {
    for (const bool game : {false, true})
        Minute().play(6.0, game);
}

TEST_CASE("bouncing, sliding and snapping shells keep the balance of energy for a minute", "[step][slow]") {
    for (const bool game : {false, true})
        Minute().play(60.0, game);
}
