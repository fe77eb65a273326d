// The alarm on energy that nobody gave: supercircle/step/energy_gain.h.

#include "supercircle/step/energy_gain.h"
#include "tests/supercircle/step/setup.h"

using namespace supercircle;
using namespace supercircle::test;

TEST_CASE("what a frame takes is no gain, what it ends with from nowhere is", "[step][energy]") {
    step::World w;
    put(w, paperShell(), Vec2::Zero(), 0.0, 0.3);
    const step::EnergyBalance before = w.energyBalance;
    w.energyBalance.friction += 1.0;
    w.energyBalance.positionCorrection -= 0.9; // closing and stopping: in and out again
    CHECK(step::gainedEnergy(before, w) == 0.0);
    w.energyBalance.positionCorrection -= 0.3;
    CHECK(step::gainedEnergy(before, w) == Approx(0.2));
    w.energyBalance.effects -= 5.0; // a spring of an effect gives back what it stored
    CHECK(step::gainedEnergy(before, w) == Approx(0.2));
}

TEST_CASE("the bound of a gain is a share of what moves, and what gaps may bring", "[step][energy]") {
    step::World w;
    put(w, paperShell(), Vec2::Zero(), 0.0, 0.3);
    const step::Settings s;
    const step::EnergyBalance before = w.energyBalance;
    const double still = step::boundOfGain(before, w, s, 1.0 / 60.0);
    // Of the one shell: an overlap of 0.04 h that closes in dtMax / 64, and 20 h/s.
    const double h = w.rods[0].model.definition().thickness, fast = (20.0 + 0.04 * 64.0 / s.dtMax) * h;
    CHECK(still == Approx(0.5 * w.rods[0].model.mass() * fast * fast));
    w.energyBalance.kinetic += 1.0;
    CHECK(step::boundOfGain(before, w, s, 1.0 / 60.0) == Approx(still + 1e-3));
    w.energyBalance.injected.contact += 1.0;
    CHECK(step::boundOfGain(before, w, s, 1.0 / 60.0) == Approx(still + 1.1e-2));
    step::Hold hold;
    hold.reaction = {0.0, 10.0};
    w.rods[0].holds.push_back(hold);
    const double held = 0.5 * w.rods[0].model.mass() * 400.0 * h * h + 10.0 * 20.0 * h / 60.0;
    CHECK(step::boundOfGain(before, w, s, 1.0 / 60.0) == Approx(still + 1.1e-2 + held));
}

TEST_CASE("a frame of a picosecond does not throw apart what was put into each other", "[step][energy]") {
    // 3 % of a thickness closes in one step, as steps make it themselves. Over 1 ps that is 15 000 km/s.
    const bool game = GENERATE(false, true);
    const double depth = GENERATE(0.005, 0.03, 0.3);
    const step::Settings s = game ? step::gameSettings() : step::Settings{};
    step::World w;
    const rod::RodDefinition d = strip(0.05, 1.0, 6);
    put(w, d, {0.0, 0.0}, 0.0, 0.3);
    put(w, d, {0.01, (1.0 - depth) * d.thickness}, 0.0, 0.3);
    step::Stepper stepper(s);
    double mostGained = 0.0, fastest = 0.0;
    for (const double dt : {1e-12, 1e-9, 1e-6, 1e-3, 1.0 / 60.0, 1.0 / 60.0}) {
        const step::FrameResult r = stepper.advance(w, dt, nullptr, {});
        REQUIRE(r.failure.empty());
        mostGained = std::max(mostGained, r.gained);
        for (const step::Rod& rod : w.rods)
            for (const Vec2& u : rod.u)
                fastest = std::max(fastest, u.norm());
    }
    CHECK(mostGained == 0.0);
    CHECK(fastest < (20.0 + 0.04 * 64.0 / s.dtMax) * d.thickness); // of the pair, so that no side is faster
}

TEST_CASE("pins that are drawn apart beyond the arc between them bring no energy from nowhere", "[step][energy]") {
    // The arc goes straight, and the reactions have no bound. They act on rows that turn within the step, and what
    // stands for that knows the reactions of the step before: it brought in a half of all the energy in one step.
    const bool game = GENERATE(false, true);
    const double speed = GENERATE(0.1, 1.0, 10.0);
    const step::Settings s = game ? step::gameSettings() : step::Settings{};
    step::World w;
    rod::RodDefinition d = strip(0.0665, 1.0, 9);
    d.naturalCurvature.assign(9, 30.0);
    put(w, d, {0.0, 0.0}, 0.0, 0.3);
    for (const double at : {0.0541, 0.0645}) {
        step::Hold h;
        h.s = at;
        h.clamped = false;
        h.target.point = w.rods[0].kin.point(rod::locate(w.rods[0].model, at));
        w.rods[0].holds.push_back(h);
    }
    const Vec2 apart = w.rods[0].holds[1].target.point - w.rods[0].holds[0].target.point;
    w.rods[0].holds[1].target.velocity = speed * apart.normalized();
    const double closing = s.recovery * w.rods[0].model.definition().thickness; // m/s
    step::Stepper stepper(s);
    double worst = 0.0, broughtIn = 0.0;
    int steps = 0;
    const auto observer = [&](const step::World& now) {
        const step::EnergyBalance& b = now.energyBalance;
        const double byGaps = 0.5 * now.rods[0].model.mass() * closing * closing;
        if (now.dt > 2.0 * s.dtMin) // the smallest step is taken as it is
            worst = std::max(worst, (b.injected.rolling - broughtIn - byGaps) / (b.kinetic + b.bending));
        broughtIn = b.injected.rolling;
        ++steps;
        return false;
    };
    for (int k = 0; k < 20; ++k) {
        const step::FrameResult r = stepper.advance(w, 0.005, nullptr, observer);
        REQUIRE(r.failure.empty());
        CHECK(r.gained == 0.0);
    }
    CHECK(steps > 20);
    CHECK(worst <= 0.1 * 1.001); // contact_stiffness.cpp; the balance of a step closes to round-off
}
