// No constant is sized for one specimen: the same experiment in other units is the same simulation.

#include "plugin/identification/replay/free_scales.h"
#include "plugin/recording/experiment/natural_units.h"
#include "tests/plugin/identification/replay/scaled.h"
#include "tests/plugin/identification/replay/support.h"
#include "tests/support/pendulum.h"

#include <cmath>

using namespace replaytest;

namespace {

/// A ring of 84 mm between plates, and back.
experiment::Experiment ring() {
    experiment::Experiment e;
    e.protocol = experiment::Protocol::RingBetweenPlates;
    e.gravity = {0.0, -9.81};
    experiment::Specimen s;
    s.id = "ring";
    s.length = M_PI * 0.084;
    s.naturalCurvature = {2.0 / 0.084, 0.0};
    s.thickness = {1e-3, 0.0};
    s.bendingModulus = {2e-3, 0.0};
    s.linearMass = {0.02, 0.0};
    e.specimens = {s};
    e.obstacles = {{experiment::ObstacleKind::Plane, {0.0, 0.0}, 0.0, {0.0, 1.0}, experiment::Carrier::Ground},
                   {experiment::ObstacleKind::Plane, {0.0, 0.086}, 0.0, {0.0, -1.0}, experiment::Carrier::Crosshead}};
    e.friction = {0.3, 0.0};
    experiment::Run run;
    run.file = "run_1.csv";
    run.driveTime = {0.0, 1.0, 11.0, 13.0, 23.0};
    run.driveDisplacement = {0.0, 0.0, 0.02, 0.02, 0.0};
    run.samplingRate = 25.0;
    e.runs = {run};
    return e;
}

replay::Parameters scaledParameters(replay::Parameters p, const experiment::Experiment& e, const Factors& f) {
    const replay::Parameters own = replay::nominal(e);
    p.specimens = own.specimens;
    p.gravity = own.gravity;
    p.seriesCompliance *= f.length / f.force;
    p.touchCompliance *= f.length / f.force;
    return p;
}

/// @param most largest difference of the force, share of its peak
void check(const experiment::Experiment& e, replay::Parameters p, double most) {
    const replay::Simulated one = simulated(e, p);
    double peak = 0.0;
    for (const double force : one.readings.force)
        peak = std::max(peak, std::abs(force));
    REQUIRE(peak > 0.0);
    for (const Factors& f : kFactors) {
        const experiment::Experiment other = scaled(e, f);
        const replay::Simulated s = simulated(other, scaledParameters(p, other, f));
        CHECK(s.steps == one.steps);
        REQUIRE(s.readings.force.size() == one.readings.force.size());
        double apart = 0.0;
        for (std::size_t k = 0; k < one.readings.force.size(); ++k)
            apart = std::max(apart, std::abs(s.readings.force[k] / f.force - one.readings.force[k]));
        INFO(words(f) << ": " << apart / peak);
        CHECK(apart <= most * peak);
    }
}

} // namespace

TEST_CASE("the reference specimen has units of 1", "[replay][units]") {
    const experiment::NaturalUnits u = experiment::unitsOfSpecimens(baseline(101));
    CHECK(u.length == 1.0);
    CHECK(u.time == 1.0);
    CHECK(u.settling == 1.0);
    CHECK(u.force == 1.0);
}

TEST_CASE("units of the files are products of powers", "[replay][units]") {
    const experiment::NaturalUnits u{2.0, 3.0, 3.0, 5.0};
    CHECK(u.of("m") == 2.0);
    CHECK(u.of("1/m") == 0.5);
    CHECK(u.of("N s/m^2") == Approx(5.0 * 3.0 / 4.0));
    CHECK(u.of("1/(N m)") == Approx(0.1));
    CHECK(u.of("kg/m") == Approx(5.0 * 9.0 / 4.0));
    CHECK(u.of("rad") == 1.0);
    CHECK(u.of("1") == 1.0);
}

// Left are slacks of 1e-12 m in the crossing check, and round-off of 1e-16, which a thousand steps with friction
// amplify.
TEST_CASE("a shell in other units is the same simulation", "[replay][units]") {
    const experiment::Experiment e = baseline(101);
    check(e, replay::nominal(e), 1e-9);
}

TEST_CASE("an arch behind a compliance in other units is the same simulation", "[replay][units]") {
    const experiment::Experiment e = baseline(106);
    replay::Parameters p = replay::nominal(e);
    p.seriesCompliance = 1.5e-5;
    check(e, p, 1e-9);
}

// A strip pressed lengthwise buckles, and a ring turns over, which amplifies both more: 2e-9 at a tenth of the size.
TEST_CASE("a strip in other units is the same simulation", "[replay][units]") {
    const experiment::Experiment e = baseline(104);
    check(e, replay::nominal(e), 1e-8);
}

TEST_CASE("a ring in other units is the same simulation", "[replay][units]") {
    const experiment::Experiment e = ring();
    check(e, replay::nominal(e), 3e-9);
}

namespace {

/// The shipped pendulum, released at rest.
experiment::Experiment pendulum(const Factors& f) {
    experiment::Experiment e = test::pendulum({0.124 * f.length, 0.0});
    e.gravity = {0.0, -9.81 * f.length / (f.time * f.time)};
    e.scene->parameters.push_back({"thickness", {0.004 * f.length, 0.0}, "m", ""});
    test::addSwing(e, 4.0 * f.time, 100.0 / f.time, {-1.9, 0.0}, {});
    return e;
}

} // namespace

TEST_CASE("a pendulum in other units is the same simulation", "[replay][units]") {
    const experiment::Experiment e = pendulum({});
    const replay::Simulated one = simulated(e, replay::nominal(e));
    for (const Factors& f : kFactors) {
        const experiment::Experiment other = pendulum(f);
        const replay::Simulated s = simulated(other, replay::nominal(other));
        INFO(words(f));
        CHECK(s.steps == one.steps);
        REQUIRE(s.readings.force.size() == one.readings.force.size());
        for (std::size_t k = 0; k < s.readings.force.size(); k += 10)
            CHECK(s.readings.force[k] == Approx(one.readings.force[k]).margin(1e-9));
    }
}
