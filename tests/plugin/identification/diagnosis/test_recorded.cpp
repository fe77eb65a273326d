// Diagnoses of shells: recordings of the reference simulator with added noise.

#include "toy.h"

#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/recording/experiment/load.h"
#include "supercircle/step/parallel.h"
#include "tests/support/folder.h"
#include "tests/support/json.h"

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

constexpr double kNoise = 0.004; // share of the peak, white and correlated part alike

experiment::Experiment noisy(int number, std::uint64_t seed) {
    auto loaded = experiment::load(std::string(SC_TEST_DATA) + "/recordings/baseline/case_" + std::to_string(number) +
                                   "/experiment.json");
    REQUIRE(loaded);
    experiment::Experiment e = *loaded;
    Random random(seed);
    double peak = 0.0;
    for (const experiment::Run& run : e.runs)
        for (const double f : run.readings.force)
            peak = std::max(peak, std::abs(f));
    e.sensors.forceNoise = kNoise * peak;
    e.sensors.markerNoise = 3e-5;
    for (experiment::Run& run : e.runs) {
        double a = 0.5 * kNoise * peak * random.normal();
        for (std::size_t k = 0; k < run.readings.force.size(); ++k) {
            const double phi = k > 0 ? std::exp(-(run.readings.time[k] - run.readings.time[k - 1]) / 0.25) : 1.0;
            a = phi * a + 0.5 * kNoise * peak * std::sqrt(1.0 - phi * phi) * random.normal();
            run.readings.force[k] += a + 0.87 * kNoise * peak * random.normal();
        }
        for (auto* axis : {&run.markers.x, &run.markers.y})
            for (std::vector<double>& track : *axis)
                for (double& v : track)
                    v += 3e-5 * random.normal();
    }
    return e;
}

Diagnosis run(const experiment::Experiment& e) {
    const ReplayModel model(e);
    SimulationCache cache;
    Evaluator evaluator(model, e.runs.size(), step::threadLoop(2), cache);
    return diagnose(recordedDataOf(e), evaluator, {});
}

int exitCode(const std::string& arguments) {
    const int status = std::system((std::string(SC_PROGRAM) + " diagnose " + arguments + " > /dev/null 2>&1").c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

} // namespace

TEST_CASE("the reference simulator's arch without extra physics is adequate", "[diagnosis][slow]") {
    const Diagnosis d = run(noisy(106, 1));
    INFO(d.statement);
    CHECK(d.verdict == "adequate");
    CHECK(d.baselineChiSquaredPerReading < 1.3);
}

TEST_CASE("a hidden sensor drift is identified", "[diagnosis][slow]") {
    experiment::Experiment e = noisy(106, 2);
    for (experiment::Run& r : e.runs)
        for (std::size_t k = 0; k < r.readings.time.size(); ++k)
            r.readings.force[k] += 12.0 * e.sensors.forceNoise * (1.0 - std::exp(-r.readings.time[k] / 8.0));
    const Diagnosis d = run(e);
    INFO(d.statement);
    REQUIRE_FALSE(d.effects.empty());
    CHECK(d.effects.front().label == "sensor_drift");
}

TEST_CASE("diagnose: bad input has exit code 2", "[diagnosis]") {
    CHECK(exitCode("no_such_file.json") == 2);
    CHECK(exitCode(std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json --without no_such") == 2);
    CHECK(exitCode(std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json --jobs 0") == 2);
    CHECK(exitCode(std::string(SC_TEST_DATA) +
                   "/recordings/baseline/case_106/experiment.json --out /proc/no/such/place") == 4);
}

TEST_CASE("diagnose reports which run cannot be simulated and what to do", "[diagnosis]") {
    const test::Folder folder;
    const std::string from = std::string(SC_TEST_DATA) + "/recordings/baseline/case_106/experiment.json";
    auto e = test::jsonOf(from);
    auto& drive = e["runs"][0];
    drive["drive_time_s"] = {0, 1, 3};
    drive["drive_displacement_mm"] = {0, 0, 30}; // the plates are 20 mm apart
    drive.erase("markers_file");
    e["markers"] = nlohmann::json::array();
    std::string rows = "time_s,displacement_mm,force_N\n";
    for (int k = 0; k < 75; ++k) {
        const double moving = std::max(0.0, 0.04 * k - 1.0);
        rows += std::to_string(0.04 * k) + "," + std::to_string(15.0 * moving) + "," +
                std::to_string(0.1 * moving + 1e-3 * (k % 3)) + "\n";
    }
    folder.write("run_1.csv", rows);
    const std::string file = folder.write("experiment.json", test::jsonText(e));
    const auto end = test::start(std::string(SC_PROGRAM) + " diagnose " + file + " --out " + folder.path + "/out");
    CHECK(end.code == 3);
    using Catch::Contains;
    CHECK_THAT(end.text, Contains(file + ": run_1.csv cannot be simulated with the stated parameters: ") &&
                             Contains("(at t = ") && Contains("`supercircle replay " + file + "`") &&
                             Contains("leave it out"));
}
