// Parameters of specimens: which value a run has, and the names by which they are set.

#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"

#include "tests/support/folder.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using Catch::Matchers::Contains;

namespace {

experiment::Experiment twoSprings() {
    const test::Folder folder;
    folder.write("run.csv", "time_s,y_mm\n0,50\n0.01,1\n");
    folder.write("again.csv", "time_s,y_mm\n0,50\n0.01,1\n");
    auto loaded = experiment::load(folder.write("experiment.json", R"({"schema": "rod-recordings/1",
        "protocol": "scene", "scene": "mass_on_spring",
        "scene_parameters": {"frequency": {"value": 2, "unc": 0.1}, "release_y": 0.05},
        "specimens": [{"id": "a", "parameters": {"damping_ratio": {"value": 0, "unc": 0.01}}},
                      {"id": "b", "parameters": {"damping_ratio": {"value": 0, "unc": 0.01}}}],
        "batch": {"frequency": {"std_rel": {"scale": 0.05}}},
        "channels": [{"observe": "position", "column": "y_mm"}],
        "runs": [{"file": "run.csv", "specimen": "b", "duration_s": 1},
                 {"file": "again.csv", "specimen": "a", "duration_s": 1}]})"));
    INFO(loaded.error());
    REQUIRE(loaded);
    for (experiment::Run& run : loaded->runs) {
        run.readings = {};
        run.samplingRate = 50.0;
        run.driveTime = {0.0, 1.0};
        run.driveDisplacement = {0.0, 0.0};
    }
    return *loaded;
}

/// Largest distance of a run from the closed form of a damped oscillation, m.
double offBy(const experiment::Experiment& e, std::size_t run, const replay::Parameters& p, double frequency,
             double damping) {
    const replay::Simulated s = replay::simulate(e, run, p, replay::Resolution::fine());
    REQUIRE(s.failure.empty());
    const double w = 2.0 * M_PI * frequency, wd = w * std::sqrt(1.0 - damping * damping);
    double worst = 0.0;
    for (std::size_t k = 0; k < s.readings.time.size(); ++k) {
        const double t = s.readings.time[k];
        const double exact =
            0.05 * std::exp(-damping * w * t) * (std::cos(wd * t) + damping * w / wd * std::sin(wd * t));
        worst = std::max(worst, std::abs(s.readings.force[k] - exact));
    }
    return worst;
}

} // namespace

TEST_CASE("a run has the values of its specimen", "[replay][specimens]") {
    const experiment::Experiment e = twoSprings();
    replay::Parameters p = replay::nominal(e);
    constexpr double kSame = 2e-6; // m: steps of 2 ms err by 1e-5 of the amplitude
    CHECK(offBy(e, 0, p, 2.0, 0.0) < kSame);
    CHECK(replay::set(p, e, "frequency.b", 2.3).empty());
    CHECK(replay::set(p, e, "damping_ratio.a", 0.05).empty());
    CHECK(offBy(e, 0, p, 2.3, 0.0) < kSame);
    CHECK(offBy(e, 1, p, 2.0, 0.05) < kSame);
    // The common value is that of specimens which do not deviate.
    CHECK(replay::set(p, e, "frequency", 1.8).empty());
    CHECK(offBy(e, 0, p, 2.3, 0.0) < kSame);
    CHECK(offBy(e, 1, p, 1.8, 0.05) < kSame);
    CHECK(*replay::get(p, e, "frequency.a") == 1.8);
    CHECK(*replay::get(p, e, "frequency.b") == 2.3);
}

TEST_CASE("parameters of specimens are listed with their intervals", "[replay][specimens]") {
    const experiment::Experiment e = twoSprings();
    std::string names;
    for (const replay::ParameterInfo& info : replay::parameterList(e)) {
        names += info.name + " ";
        if (info.name == "damping_ratio.b")
            CHECK(info.stated.halfWidth == 0.01);
        CHECK(info.ofBatch == (info.name == "frequency.a" || info.name == "frequency.b"));
    }
    CHECK_THAT(names,
               Contains("frequency release_y damping_ratio.a frequency.a damping_ratio.b frequency.b gravity_x"));
    replay::Parameters p = replay::nominal(e);
    CHECK_THAT(replay::set(p, e, "frequency.c", 1.0), Contains("did you mean \"frequency"));
    CHECK_FALSE(replay::get(p, e, "release_y.a"));
}
