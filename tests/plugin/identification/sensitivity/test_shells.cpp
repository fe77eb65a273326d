// Derivatives of simulated shells against mechanics, and the subcommand.

#include "plugin/identification/sensitivity/sensitivity.h"
#include "plugin/recording/experiment/load.h"
#include "tests/support/folder.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

using namespace supercircle;
using Catch::Contains;

namespace {

std::string path(int number) {
    return std::string(SC_TEST_DATA) + "/recordings/baseline/case_" + std::to_string(number) + "/experiment.json";
}

experiment::Experiment baseline(int number) {
    auto loaded = experiment::load(path(number));
    INFO(loaded.error());
    REQUIRE(loaded);
    return *loaded;
}

double rms(const Eigen::VectorXd& v) {
    return std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

} // namespace

TEST_CASE("without weight the force is proportional to the bending modulus and follows the crosshead",
          "[sensitivity]") {
    const experiment::Experiment e = baseline(101);
    replay::Parameters p = replay::nominal(e);
    p.gravity = {};
    std::string error;
    const sensitivity::Model model = sensitivity::replayModel(e, p, replay::Resolution::coarse(),
                                                              {"bending_modulus", "gap_shift", "linear_mass"}, error);
    REQUIRE(error.empty());
    sensitivity::SensitivitySettings settings;
    settings.jobs = 2;
    const sensitivity::Sensitivities s = sensitivity::differentiate(model, e, settings);
    const sensitivity::RunSensitivity& run = s.runs.at(0);
    const experiment::Readings& r = run.base.readings;
    const Eigen::Map<const Eigen::VectorXd> force(r.force.data(), static_cast<Eigen::Index>(r.force.size()));
    // dF/dB = F / B: elastic and Coulomb forces scale with B, inertia is 1e-7 of them. The solver noise is 0.7 %.
    const Eigen::VectorXd exact = force / e.specimens[0].bendingModulus.value;
    const Eigen::VectorXd away = run.usable.col(0).select((run.force.col(0) - exact).array(), 0.0);
    CHECK(rms(away) < 0.015 * rms(exact));
    // A higher crosshead is at the same position later: dF/dgap = -dF/dx in loading, away from first contact and
    // reversal.
    double error2 = 0.0, size2 = 0.0;
    for (std::size_t i = 80; i + 20 < r.time.size() && r.time[i] < 12.0; ++i) {
        const double slope = (r.force[i + 1] - r.force[i - 1]) / (r.displacement[i + 1] - r.displacement[i - 1]);
        error2 += std::pow(run.force(static_cast<Eigen::Index>(i), 1) + slope, 2);
        size2 += slope * slope;
    }
    CHECK(std::sqrt(error2 / size2) < 0.03); // slopes of samples 40 ms apart, and a noise of 6 % per sample
    CHECK(run.quality[2].belowNoise);        // without gravity mass is inertia only
    // the bending modulus shifts no jump; energy is proportional to it
    const auto at = std::find(run.landmarks.names.begin(), run.landmarks.names.end(), "loop_area");
    REQUIRE(at != run.landmarks.names.end());
    const auto row = static_cast<Eigen::Index>(at - run.landmarks.names.begin());
    CHECK(run.landmarkJacobian(row, 0) ==
          Approx(run.landmarks.values[static_cast<std::size_t>(row)] / e.specimens[0].bendingModulus.value)
              .epsilon(0.005));
}

TEST_CASE("a parameter of one specimen and a shared one are distinguished", "[sensitivity]") {
    const experiment::Experiment e = baseline(103);
    std::string error;
    const replay::Parameters p = replay::nominal(e);
    const sensitivity::Model model = sensitivity::replayModel(
        e, p, replay::Resolution::coarse(), {"bending_modulus", "bending_modulus.A", "bending_modulus.B"}, error);
    REQUIRE(error.empty());
    const sensitivity::Sensitivities s = sensitivity::differentiate(model, e, {});
    const Eigen::MatrixXd& j = s.runs.at(0).force;
    const Eigen::VectorXd sum = j.col(1) + j.col(2);
    CHECK(rms(sum - j.col(0)) < 0.02 * rms(j.col(0))); // the chain rule, within noise
    std::string why;
    (void)sensitivity::replayModel(e, p, replay::Resolution::coarse(), {"bending_moduls"}, why);
    CHECK_THAT(why, Contains("did you mean \"bending_modulus\"?"));
}

TEST_CASE("jumps are placed between samples by the trace", "[sensitivity]") {
    experiment::Run run;
    run.driveTime = {0.0, 10.0};
    run.driveDisplacement = {0.0, 1e-2};
    run.samplingRate = 5.0;
    const double jump = 4.137; // s, 1 mm/s
    const auto curve = [&](double rate) {
        experiment::Readings r;
        for (int i = 0; i <= static_cast<int>(10.0 * rate); ++i) {
            const double t = i / rate;
            r.time.push_back(t);
            r.displacement.push_back(1e-3 * t);
            r.force.push_back(t < jump ? 1.0 : 0.2);
        }
        return r;
    };
    const experiment::Readings samples = curve(5.0), trace = curve(1000.0);
    const sensitivity::Landmarks coarse = sensitivity::measure(run, samples);
    const sensitivity::Landmarks fine = sensitivity::measure(run, samples, &trace);
    REQUIRE(coarse.names.at(0) == "jump1_displacement");
    CHECK(std::abs(coarse.values[0] - 1e-3 * jump) <= coarse.samplingError[0]);
    CHECK(coarse.samplingError[0] == Approx(1e-4));
    CHECK(fine.values[0] == Approx(1e-3 * jump).margin(1e-6));
    // work: 1 N over 4.137 mm and 0.2 N over the rest, known to a sample
    const auto at = std::find(fine.names.begin(), fine.names.end(), "loop_area") - fine.names.begin();
    CHECK(fine.values[static_cast<std::size_t>(at)] == Approx(4.137e-3 + 0.2 * 5.863e-3).margin(1e-4));
}

TEST_CASE("sensitivity writes tables and figures", "[sensitivity]") {
    const test::Folder own;
    const std::string& folder = own.path;
    const auto start = [](const std::string& arguments) {
        return test::start(std::string(SC_PROGRAM) + " sensitivity " + arguments).code;
    };
    CHECK(start(path(106) + " --column friction --column thickness --jobs 2 --out " + folder + "/a") == 0);
    for (const char* name : {"sensitivity.json", "landmarks.csv", "run_1_sensitivity.csv",
                             "run_1_sensitivity_markers.csv", "run_1_sensitivity.png", "sensitivity.html"})
        CHECK(std::filesystem::file_size(folder + "/a/" + name) > 500);
    CHECK(start(path(106) + " --column frction --out " + folder + "/b") == 2);
    CHECK(start(path(106) + " --param friction=-1 --out " + folder + "/b") == 2);
    CHECK_FALSE(std::filesystem::exists(folder + "/b"));
}

TEST_CASE("amplitudes of effects are columns, including those that are infinite when absent", "[sensitivity]") {
    const experiment::Experiment e = baseline(106);
    const replay::Parameters p = replay::nominal(e);
    std::string error;
    const sensitivity::Model model = sensitivity::replayModel(
        e, p, replay::Resolution::fine(),
        {"series_compliance", "machine_compliance:k_N_m", "sensor_gain:error", "sensor_drift:rate_N_s"}, error);
    REQUIRE(error.empty());
    REQUIRE(model.columns.size() == 4);
    CHECK(model.columns[1].name == "machine_compliance:1/k_N_m");
    CHECK(model.columns[1].value == 0.0);
    const sensitivity::Sensitivities s = sensitivity::differentiate(model, e, {});
    REQUIRE(s.failure.empty());
    const sensitivity::RunSensitivity& run = s.runs[0];
    double ab = 0.0, aa = 0.0, bb = 0.0;
    for (Eigen::Index i = 0; i < run.force.rows(); ++i) {
        if (!run.usable.row(i).all())
            continue;
        ab += run.force(i, 0) * run.force(i, 1);
        aa += run.force(i, 0) * run.force(i, 0);
        bb += run.force(i, 1) * run.force(i, 1);
        const auto k = static_cast<std::size_t>(i);
        // Gain and steady drift are exact: the force itself, and the time, with the same zero.
        CHECK(run.force(i, 2) == Approx(run.base.readings.force[k]).margin(1e-3));
        CHECK(run.force(i, 3) == Approx(run.base.readings.time[k] - 0.25).margin(0.05));
    }
    // Both are compliances in series with the crosshead. One has a ten times larger step, which shifts the reversals by
    // some samples: the same direction (cosine above 0.9), other values.
    CHECK(ab > 0.9 * std::sqrt(aa * bb));
    CHECK(sensitivity::effectNames(e).size() >= 20);
}
