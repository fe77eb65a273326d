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

TEST_CASE("the bound of a gain is the same for an island, whose balance begins at zero", "[step][energy]") {
    step::World w;
    put(w, paperShell(), Vec2::Zero(), 0.0, 0.3);
    const step::Settings s;
    const double still = step::boundOfGain(w.energyBalance, w, s, 1.0 / 60.0);
    for (Vec2& u : w.rods[0].u)
        u = {3.0, 4.0};
    w.energyBalance = {};
    const double kinetic = 0.5 * w.rods[0].model.mass() * 25.0;
    CHECK(step::boundOfGain({}, w, s, 1.0 / 60.0) == Approx(still + 1e-3 * kinetic));
    w.energyBalance.kinetic = -kinetic; // it was twice as much before
    CHECK(step::boundOfGain({}, w, s, 1.0 / 60.0) == Approx(still + 2e-3 * kinetic));
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

TEST_CASE("two shells made at one place part gently", "[step][energy]") {
    // Their centre lines coincide, and the normals between them are round-off that contradict each other: rings were
    // given 6e10 J, and most of their steps had no solution.
    const bool game = GENERATE(false, true);
    const bool closed = GENERATE(false, true);
    const double off = GENERATE(0.0, 1e-9, 0.01, 0.05, 0.2); // of the thickness
    const step::Settings s = game ? step::gameSettings() : step::Settings{};
    step::World w;
    const rod::RodDefinition d = closed ? ring(0.02, 1.0) : paperShell();
    put(w, d, {0.0, 0.0}, 0.0, 0.3);
    put(w, d, {0.0, off * d.thickness}, 0.0, 0.3);
    step::Stepper stepper(s);
    for (int k = 0; k < 20; ++k) {
        const step::FrameResult r = stepper.advance(w, 0.01, nullptr, {});
        REQUIRE(r.failure.empty());
        CHECK(r.gained == 0.0);
    }
    CHECK(w.counters.unconverged == 0);
    // What soft contacts may carry (kContactForces of overlaps.cpp, of both shells) over a thickness, at 30 of them.
    CHECK(w.energyBalance.injected.contact <
          30.0 * 50.0 * 2.0 * d.bendingModulus / (d.length * d.length) * d.thickness);
}

TEST_CASE("in a frame of a picosecond a held point goes its share of the way", "[step][energy]") {
    // 2 mm over 1 ps are six times the speed of light: the hold worked 6e13 J, and the step kept 2e12 J of its own.
    const bool game = GENERATE(false, true);
    const bool clamped = GENERATE(false, true);
    const step::Settings s = game ? step::gameSettings() : step::Settings{};
    const double time = s.dtMax / 64.0; // that the way takes in shorter frames (gap_closing.h)
    step::World w;
    put(w, ring(0.009, 1.0), {0.0, 0.0}, 0.0, 0.3);
    step::Hold h;
    h.s = 0.03;
    h.clamped = clamped;
    const rod::MaterialPoint at = rod::locate(w.rods[0].model, h.s);
    h.target.point = w.rods[0].kin.point(at);
    h.target.angle = w.rods[0].kin.angle(at);
    h.target.pending = true;
    h.target.path.to = h.target.point + Vec2(0.002, 0.0);
    h.target.path.toAngle = h.target.angle;
    const Vec2 to = h.target.path.to;
    w.rods[0].holds.push_back(h);
    step::Stepper stepper(s);
    double fastest = 0.0, gone = 0.0;
    for (const double dt : {1e-12, 1e-12, 1e-9, time}) {
        const step::FrameResult r = stepper.advance(w, dt, nullptr, {});
        REQUIRE(r.failure.empty());
        CHECK(r.gained == 0.0);
        fastest = std::max(fastest, w.rods[0].speed);
        gone += r.advanced;
    }
    CHECK(gone >= time);
    CHECK((w.rods[0].kin.point(at) - to).norm() < 0.05 * w.rods[0].model.definition().thickness);
    CHECK(fastest < 20.0 * 0.002 / time); // the mean speed, the bends that it makes besides
}

TEST_CASE("in a frame of a picosecond a body that was put forward goes its share of the way", "[step][energy]") {
    const bool game = GENERATE(false, true);
    const step::Settings s = game ? step::gameSettings() : step::Settings{};
    step::World w;
    FakeHost host;
    host.add(1, "wall", {-0.0105, 0.0}).outlines.push_back(FakeHost::box(1, 0.01, 0.05, 0.3));
    put(w, strip(0.05, 1.0, 6), {0.0, 0.0}, 0.5 * M_PI, 0.3);
    step::Stepper stepper(s);
    frame(stepper, w, host, 0.001);
    host.bodies.at(1).state.centre.x() += 0.005;
    double fastest = 0.0;
    for (const double dt : {1e-12, 1e-9, 1e-6, 0.001, 0.001}) {
        frame(stepper, w, host, dt);
        fastest = std::max(fastest, w.rods[0].speed);
    }
    CHECK(fastest < 3.0 * 0.005 / (s.dtMax / 64.0));
    CHECK(centre(w.rods[0]).x() > 0.004); // it was pushed all the way
}
