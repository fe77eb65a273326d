// The reference simulator against closed forms. It is used to judge the diagnosis, so nothing here compares it with
// this project's simulator.

#include "tests/reference_simulator/simulation.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle::reference_simulator;

namespace {

/// A straight strip clamped level at its first end.
Setup cantilever() {
    Setup s;
    Specimen strip;
    strip.length = 0.05;
    strip.modulus = 2e-4;
    strip.clamp = ClampAt::FirstEnd;
    strip.onCrosshead = true;
    s.specimens = {strip};
    return s;
}

constexpr double kArm = 0.045; ///< from the clamp to the pin, m: a node lies there

/// The same above a smooth thin pin, in contact without force.
Setup pressedCantilever() {
    Setup s = cantilever();
    s.friction = 0.0;
    Obstacle pin;
    pin.cylinder = true;
    pin.radius = 1e-4;
    pin.point = {kArm, -pin.radius - 0.5 * s.specimens[0].thickness};
    s.obstacles = {pin};
    return s;
}

Drive straightTo(double depth, double from, double to, double end) {
    return {{0.0, from, to, end}, {0.0, 0.0, depth, depth}};
}

std::vector<double> every(double dt, double end) {
    std::vector<double> out;
    for (int i = 0; i * dt < end; ++i)
        out.push_back(i * dt);
    return out;
}

double forceAt(const Trace& trace, const Effects& e, double t) {
    return readings(trace, e, {t}).front();
}

/// Shell of opening angle 2 pi `open` above a cylinder of its own radius (centre lines); thin, without weight.
Setup onCylinder(double open, double friction) {
    Setup s;
    Specimen shell;
    const double radius = 0.02, half = M_PI * open;
    shell.thickness = 1e-5;
    shell.curvature = 1.0 / radius;
    shell.length = 2.0 * half * radius;
    shell.modulus = 2e-4;
    shell.clamp = ClampAt::Middle;
    shell.onCrosshead = true;
    shell.angle = M_PI;
    // Tips at angle `half` from the top of the shell touch the cylinder where its outline has the same width.
    const double tipWidth = radius * std::sin(half);
    const double height = std::sqrt(radius * radius - tipWidth * tipWidth);
    shell.point = {0.0, height + radius * (1.0 - std::cos(half)) + 2e-5};
    Obstacle cylinder;
    cylinder.cylinder = true;
    cylinder.radius = radius - 0.5 * shell.thickness;
    s.specimens = {shell};
    s.obstacles = {cylinder};
    s.friction = friction;
    return s;
}

} // namespace

TEST_CASE("a heavy cantilever sags by the beam formula", "[reference_simulator]") {
    Setup s = cantilever();
    s.gravity = {0.0, -0.5}; // a sag of 1 % of the length: the linear formula holds to 1e-4
    Simulation sim(s, {});
    REQUIRE(sim.settle(20.0));
    const Specimen& strip = s.specimens[0];
    const double load = strip.linearMass * 0.5, l4 = std::pow(strip.length, 4);
    CHECK(-sim.point({0, 1.0}).y() ==
          Approx(load * l4 / (8.0 * strip.modulus)).epsilon(2e-3));   // O(1 / edges^2) and sag^2
    CHECK(sim.force() == Approx(-load * strip.length).epsilon(1e-3)); // it hangs on the crosshead
}

TEST_CASE("a cantilever pressed on a smooth pin is a spring", "[reference_simulator]") {
    const double depth = 2e-4;
    Setup s = pressedCantilever();
    const double k = 3.0 * s.specimens[0].modulus / std::pow(kArm, 3);
    Simulation sim(s, {});
    REQUIRE(sim.settle(1.0));
    const Trace t = sim.run(straightTo(depth, 0.5, 1.5, 3.0), every(0.1, 3.0), {});
    REQUIRE(t.failure.empty());
    CHECK(forceAt(t, {}, 2.5) ==
          Approx(k * depth).epsilon(2e-3)); // second order in a deflection of 0.4 % of the length
}

TEST_CASE("viscous and ageing laws follow their closed forms on the spring", "[reference_simulator]") {
    const double depth = 2e-4;
    Setup s = pressedCantilever();
    const double k = 3.0 * s.specimens[0].modulus / std::pow(kArm, 3);
    SECTION("Kelvin-Voigt: force proportional to the rate") {
        s.effects.kelvinVoigtTime = 0.3;
        Simulation sim(s, {});
        REQUIRE(sim.settle(1.0));
        const Trace t = sim.run(straightTo(depth, 0.5, 1.5, 3.0), every(0.02, 3.0), {});
        CHECK(forceAt(t, {}, 1.0) == Approx(k * (0.5 * depth + 0.3 * depth)).epsilon(5e-3)); // 1 %: the first contact
        CHECK(forceAt(t, {}, 2.5) == Approx(k * depth).epsilon(2e-3));
    }
    SECTION("standard linear solid: relaxation in a hold") {
        s.effects.branch = 0.4;
        s.effects.branchTime = 0.7;
        Simulation sim(s, {});
        REQUIRE(sim.settle(1.0));
        const Trace t = sim.run(straightTo(depth, 0.5, 0.51, 3.0), every(0.02, 3.0), {});
        for (const double after : {0.3, 1.0, 2.0})
            CHECK(
                forceAt(t, {}, 0.505 + after) ==
                Approx(k * depth * (1.0 + 0.4 * std::exp(-after / 0.7))).epsilon(5e-3)); // the ramp takes 1.4 % of tau
    }
    SECTION("softening with time") {
        s.effects.softening = 0.3;
        s.effects.softeningTime = 2.0;
        Simulation sim(s, {});
        REQUIRE(sim.settle(1.0));
        const Trace t = sim.run(straightTo(depth, 0.5, 1.5, 3.0), every(0.05, 3.0), {});
        CHECK(forceAt(t, {}, 2.0) == Approx(k * depth * (0.7 + 0.3 * std::exp(-1.0))).epsilon(3e-3));
    }
    SECTION("a compliant machine takes its share of the travel") {
        s.effects.machineStiffness = 2.0 * k;
        Simulation sim(s, {});
        REQUIRE(sim.settle(1.0));
        const Trace t = sim.run(straightTo(depth, 0.5, 1.5, 3.0), every(0.1, 3.0), {});
        CHECK(forceAt(t, {}, 2.5) == Approx(k * depth / 1.5).epsilon(3e-3));
    }
    SECTION("a compliant pin takes its share of the travel") {
        s.effects.normalCompliance = 0.05 / k;
        Simulation sim(s, {});
        REQUIRE(sim.settle(1.0));
        const Trace t = sim.run(straightTo(depth, 0.5, 1.5, 3.0), every(0.1, 3.0), {});
        CHECK(forceAt(t, {}, 2.5) == Approx(k * depth / 1.05).epsilon(3e-3));
    }
}

TEST_CASE("a shell slides over a cylinder with the peak forces of theory", "[reference_simulator]") {
    // Theory for zero thickness, in units of B / R^2, with Phi_bar 0.75 and mu 0.35: 0.1056 pushing, -0.1533 pulling.
    Setup s = onCylinder(0.75, 0.35);
    Simulation sim(s, {});
    REQUIRE(sim.settle(0.5));
    const Trace t = sim.run({{0.0, 0.1, 4.1, 8.1}, {0.0, 0.0, 0.0275, 0.0}}, every(0.02, 8.1), {});
    REQUIRE(t.failure.empty());
    const double unit = s.specimens[0].modulus / (0.02 * 0.02);
    CHECK(*std::max_element(t.force.begin(), t.force.end()) / unit ==
          Approx(0.1056).epsilon(5e-3)); // four digits given
    CHECK(*std::min_element(t.force.begin(), t.force.end()) / unit == Approx(-0.1533).epsilon(5e-3));
}

TEST_CASE("walls drag with the force f L before contact", "[reference_simulator]") {
    Setup s = onCylinder(0.75, 0.3);
    s.specimens[0].point.y() += 0.002;
    s.effects.drag = 0.02; // weak: the shell moves nearly as a rigid body
    Simulation sim(s, {});
    REQUIRE(sim.settle(0.5));
    const Trace t = sim.run({{0.0, 0.1, 1.1, 2.1}, {0.0, 0.0, 0.001, 0.0}}, every(0.05, 2.1), {});
    REQUIRE(t.failure.empty());
    const double whole = 0.02 * s.specimens[0].length;
    CHECK(forceAt(t, {}, 1.0) == Approx(whole).epsilon(1e-3));
    CHECK(forceAt(t, {}, 2.0) == Approx(-whole).epsilon(1e-3));
}

TEST_CASE("sensors and backlash follow their formulas", "[reference_simulator]") {
    Trace ramp;
    for (int i = 0; i <= 100; ++i) {
        ramp.time.push_back(0.1 * i);
        ramp.force.push_back(0.1 * i);
    }
    Effects e;
    e.gain = 0.1;
    e.drift = 0.5;
    e.driftTime = 2.0;
    CHECK(readings(ramp, e, {4.0}).front() == Approx(4.4 + 0.5 * (1.0 - std::exp(-2.0))));
    Effects late;
    late.delay = 0.25;
    CHECK(readings(ramp, late, {4.0}).front() == Approx(3.75));
    late = {};
    late.lag = 0.2; // behind a ramp by its time constant
    CHECK(readings(ramp, late, every(0.1, 5.0)).back() == Approx(4.9 - 0.2).epsilon(3e-3));
    const Drive d = behindBacklash({{0.0, 1.0, 3.0, 5.0}, {0.0, 0.0, 2.0, 0.0}}, 0.5);
    CHECK(d.at(3.0) == Approx(2.0));
    CHECK(d.at(3.5) == Approx(2.0)); // lost in the backlash
    CHECK(d.at(5.0) == Approx(0.5));
}
