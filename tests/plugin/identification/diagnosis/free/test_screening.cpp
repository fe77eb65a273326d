// Effects far smaller than their probes, in swings that the probes throw out of phase.

#include "../belt.h"

#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/replay/simulate.h"

using namespace supercircle;
using namespace supercircle::diagnosis;

TEST_CASE("a spring that hardens by a part in a thousand is found in nine swings", "[diagnosis][free]") {
    // Its relevant amplitude, which screening tries, shifts the last of nine swings by a third of a period; the true
    // one by 3 % of that, 8 degrees at most.
    const test::Folder folder;
    for (const char* file : {"small.csv", "large.csv"})
        folder.write(file, "time_s,angle_deg\n0,0\n0.03,1\n");
    const auto loaded = experiment::load(folder.write("experiment.json",
                                                      R"({"schema": "rod-recordings/1", "protocol": "scene",
        "scene": "torsional_pendulum", "scene_parameters": {"frequency": {"value": 0.75, "unc": 0.02}},
        "channels": [{"observe": "angle", "column": "angle_deg", "noise_std": 0.2, "zero": {"value": 0, "unc": 0.5}}],
        "runs": [{"file": "small.csv", "parameters": {"release_angle": {"value": 0.41, "unc": 0.02}}, "duration_s": 9},
                 {"file": "large.csv", "parameters": {"release_angle": {"value": 1.38, "unc": 0.02}}, "duration_s": 9}]})"));
    INFO(loaded.error());
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    constexpr double kCubic = 0.0025, kNoise = 0.2 * M_PI / 180.0; // 1/rad^2, rad
    replay::Parameters truth = replay::nominal(e);
    REQUIRE(effects::add(truth.effects, "nonlinear_spring:cubic_1_rad2=" + std::to_string(kCubic)) == "");
    Random random(3);
    for (std::size_t r = 0; r < e.runs.size(); ++r) {
        e.runs[r].readings = {};
        e.runs[r].samplingRate = 1.0 / 0.03;
        e.runs[r].readings = replay::simulate(e, r, truth, replay::Resolution::fine()).readings;
        for (double& v : e.runs[r].readings.force)
            v += kNoise * random.normal();
    }
    const Diagnosis d = shortDiagnosis(ReplayModel(e), e);
    INFO(d.statement);
    REQUIRE(d.verdict == "identified");
    CHECK(d.effects.front().label == "nonlinear_spring");
    // 12 sigma or more behind frequency and release: 8 % of the amplitude, three of them.
    CHECK(d.effects.front().parameters.front().value == Approx(kCubic).epsilon(0.25));
}
