// Several channels of one simulated run against closed forms.

#include "plugin/identification/replay/compare.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"

#include "tests/support/folder.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;

namespace {

experiment::Experiment loaded(const std::string& description, const std::string& rows) {
    const test::Folder folder;
    folder.write("run.csv", rows);
    auto out = experiment::load(folder.write("experiment.json", description));
    INFO(out.error());
    REQUIRE(out);
    return *out;
}

} // namespace

TEST_CASE("position, velocity and acceleration of a mass on a spring belong together", "[replay][mechanism]") {
    auto e = loaded(R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": "mass_on_spring", "channels": [
        {"observe": "position", "column": "y_mm"}, {"observe": "velocity", "column": "v_m_s"},
        {"observe": "acceleration", "column": "a_m_s2", "zero": {"value": 0.3}}],
        "runs": [{"file": "run.csv"}]})",
                    "time_s,y_mm,v_m_s,a_m_s2\n0,50,0,1\n1,20,0.1,2\n2,10,0.2,3\n");
    const double w = 2.0 * M_PI * 1.5;
    const auto s = replay::simulate(e, 0, replay::nominal(e), replay::Resolution::fine());
    REQUIRE(s.failure.empty());
    REQUIRE(s.readings.further.size() == 2);
    for (std::size_t k = 0; k < s.readings.time.size(); ++k) {
        const double t = s.readings.time[k]; // the step of the integrator errs by 1e-6 of a period
        CHECK(s.readings.force[k] == Approx(0.05 * std::cos(w * t)).margin(1e-6));
        CHECK(s.readings.further[0][k] == Approx(-0.05 * w * std::sin(w * t)).margin(1e-5));
        CHECK(s.readings.further[1][k] == Approx(0.3 - w * w * 0.05 * std::cos(w * t)).margin(1e-4));
    }
    // its zero is a parameter of its own
    replay::Parameters p = replay::nominal(e);
    CHECK(replay::get(p, e, "reading_zero.acceleration").value() == Approx(0.3));
    REQUIRE(replay::set(p, e, "reading_zero.acceleration", 0.0).empty());
    const auto moved = replay::simulate(e, 0, p, replay::Resolution::fine());
    CHECK(moved.readings.further[1][0] == Approx(s.readings.further[1][0] - 0.3));
    CHECK(moved.readings.force == s.readings.force);
    // errors of each channel
    e.runs.front().readings = s.readings;
    for (double& v : e.runs.front().readings.further[1])
        v -= 0.3;
    const replay::Comparison c = replay::compare(e.runs.front(), s, {}, false);
    REQUIRE(c.further.size() == 2);
    CHECK(c.rmse == 0.0);
    CHECK(c.further[0].rmse == 0.0);
    CHECK(c.further[1].rmse == Approx(0.3));
}

TEST_CASE("a second channel changes nothing in the first", "[replay][rods]") {
    const auto described = [](const std::string& more) {
        return R"({"schema": "rod-recordings/1", "protocol": "scene", "scene": "three_point_bending",
        "gravity_m_s2": [0, -0.1], "scene_parameters": {"roller_radius": 1e-4, "nose_radius": 1e-4,
        "thickness": 5e-4, "nose_gap": 1e-8, "mu": 0.01},
        "channels": [{"observe": "force", "column": "force_N"})" +
               more +
               R"(], "runs": [{"file": "run.csv", "drive_time_s": [0, 10], "drive_displacement_mm": [0, 0.1]}]})";
    };
    const std::string rows =
        "time_s,force_N,middle_mm,travel_mm\n0,0,0,0\n5,1,0.05,0.05\n9.9,2,0.1,0.1\n10,3,0.1,0.1\n";
    const auto one = loaded(described(""), rows);
    const auto three = loaded(described(R"(, {"observe": "midspan", "column": "middle_mm", "sign": -1},
        {"observe": "travel", "column": "travel_mm"})"),
                              rows);
    const auto a = replay::simulate(one, 0, replay::nominal(one), replay::Resolution::fine());
    const auto b = replay::simulate(three, 0, replay::nominal(three), replay::Resolution::fine());
    REQUIRE(b.failure.empty());
    CHECK(a.readings.force == b.readings.force);
    REQUIRE(b.readings.further.size() == 2);
    // The nose stays on the middle of the strip: the deflection is the travel, to the approach of thin rollers.
    const std::vector<double>&middle = b.readings.further[0], &travel = b.readings.further[1];
    CHECK(travel.back() == Approx(1e-4));
    CHECK(middle.front() - middle.back() == Approx(travel.back()).epsilon(1e-2));
    CHECK(middle.front() - middle[1] == Approx(travel[1]).epsilon(1e-2));
}
