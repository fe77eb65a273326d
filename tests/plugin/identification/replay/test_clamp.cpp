// Clamps that yield, against closed forms.

#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/effects/effect.h"

#include "tests/support/folder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;

namespace {

constexpr double kFree = 0.3, kStrip = 7800.0 * 0.02 * 1e-3; // length, m; mass of a length, kg/m
const double kBending = 2e11 * 0.02 * 1e-9 / 12.0;           // N m^2

experiment::Experiment described(const std::string& scene, const std::string& rows, const std::string& more) {
    const test::Folder folder;
    folder.write("run.csv", rows);
    const std::string file = folder.write("experiment.json", R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": ")" + scene + R"(", )" + more);
    auto out = experiment::load(file);
    INFO(out.error());
    REQUIRE(out);
    return *out;
}

/// @param compliance in units of length over modulus
experiment::Readings played(const experiment::Experiment& e, double compliance) {
    replay::Parameters p = replay::nominal(e);
    REQUIRE(effects::add(p.effects,
                         "clamp_compliance:compliance_rad_N_m=" + std::to_string(compliance * kFree / kBending)) == "");
    REQUIRE(replay::checkEffects(p, e) == "");
    const auto out = replay::simulate(e, 0, p, replay::Resolution::fine());
    REQUIRE(out.failure == "");
    return out.readings;
}

/// Smallest root beta L of a clamped-free beam whose clamp turns by compliance (of length over modulus) times its
/// moment: 1 + cos cosh = compliance beta L (sin cosh - cos sinh).
double rootOf(double compliance) {
    const auto f = [&](double b) {
        return 1.0 + std::cos(b) * std::cosh(b) -
               compliance * b * (std::sin(b) * std::cosh(b) - std::cos(b) * std::sinh(b));
    };
    double low = 1e-3, high = 1.8752;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (f(middle) > 0.0 ? low : high) = middle;
    }
    return low;
}

} // namespace

TEST_CASE("a cantilever in a clamp that yields sags by its turning as well", "[replay][rods]") {
    // P L^2 / B = 0.02: second-order terms are below 1e-4, and 48 arcs err by 2e-4.
    const double weight = 0.02 * kBending / (kFree * kFree); // N
    std::string rows = "time_s,weight_g,tip_mm\n0,0,0\n";
    for (int i = 1; i < 4; ++i)
        rows += std::to_string(10 * i) + "," + std::to_string(i * 1e3 / 3.0 * weight / 9.81) + ",-1\n";
    const auto e = described("cantilever_weights", rows,
                             R"("scene_parameters": {"gravity": 0},
        "drive": {"parameter": "weight", "column": "weight_g", "scale": 9.81e-3},
        "channels": [{"observe": "tip_y", "column": "tip_mm"}], "runs": [{"file": "run.csv"}]})");
    const double sag = weight * kFree * kFree * kFree / (3.0 * kBending);
    for (const double compliance : {0.0, 0.02, 0.3})
        CHECK(-played(e, compliance).force.back() == Approx(sag * (1.0 + 3.0 * compliance)).epsilon(4e-4));
}

TEST_CASE("a cantilever in a clamp that yields swings with the frequency of the closed form", "[replay][rods]") {
    auto e = described("cantilever_vibration", "time_s,tip_mm\n0,0\n0.001,1\n",
                       R"("scene_parameters": {"pull": 0.005},
        "channels": [{"observe": "tip_y", "column": "tip_mm"}], "runs": [{"file": "run.csv", "duration_s": 1.2}]})");
    e.runs.front().readings = {};
    e.runs.front().samplingRate = 4000.0;
    for (const double compliance : {0.02, 0.3}) {
        const experiment::Readings r = played(e, compliance);
        std::vector<double> crossings;
        for (std::size_t i = 1; i < r.time.size(); ++i)
            if (r.force[i - 1] < 0.0 && r.force[i] >= 0.0)
                crossings.push_back(r.time[i - 1] -
                                    r.force[i - 1] * (r.time[i] - r.time[i - 1]) / (r.force[i] - r.force[i - 1]));
        REQUIRE(crossings.size() > 6);
        // As with a rigid clamp: the higher modes shift crossings by less than 1e-3 of six periods, 12 arcs by 1e-4.
        CHECK(2.0 * M_PI * 6.0 / (crossings[6] - crossings[0]) ==
              Approx(std::pow(rootOf(compliance) / kFree, 2) * std::sqrt(kBending / kStrip)).epsilon(1e-3));
        // It keeps its amplitude: 97 % of the energy is in the first mode of a rigid clamp, and more where it yields.
        const auto half = static_cast<std::ptrdiff_t>(r.force.size() / 2);
        CHECK(*std::max_element(r.force.begin() + half, r.force.end()) ==
              Approx(0.005 * std::pow(kFree, 3) / (3.0 * kBending) * (1.0 + 3.0 * compliance)).epsilon(0.05));
    }
}

TEST_CASE("a clamp's compliance acts where there is a clamp", "[replay][parameters]") {
    const auto why = [&](const std::string& scene, const std::string& column, const std::string& rest) {
        const auto e = described(scene, "time_s," + column + "\n0,0\n1,1\n", rest);
        replay::Parameters p = replay::nominal(e);
        REQUIRE(effects::add(p.effects, "clamp_compliance:compliance_rad_N_m=1") == "");
        return replay::checkEffects(p, e);
    };
    CHECK(why("euler_strut", "force_N", R"("channels": [{"observe": "force", "column": "force_N"}],
        "runs": [{"file": "run.csv", "drive_time_s": [0, 1], "drive_displacement_mm": [0, 1]}]})") != "");
    CHECK(why("pendulum", "angle_deg", R"("channels": [{"observe": "angle", "column": "angle_deg"}],
        "runs": [{"file": "run.csv"}]})") != "");
}
