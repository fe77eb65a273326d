// Fits of free runs end in one minimum, whatever the start and the width of the
// stated intervals.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/replay/simulate.h"
#include "tests/support/pendulum.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// A made-up pendulum with dry friction, released twice. Its true numbers lie
/// inside the intervals, which are `box` times the usual ones.
experiment::Experiment pendulum(std::uint64_t seed, double box) {
    Random random(seed);
    const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
    const double length = between(0.1, 0.3), friction = between(0.2, 1.0) * 2e-4;
    experiment::Experiment e = test::pendulum({length, 0.02 * box * length});
    e.scene->zero.halfWidth = 0.5 * kDegree * box;
    e.sensors.forceNoise = 0.1 * kDegree;
    for (int r = 0; r < 2; ++r)
        test::addSwing(e, 3.0, 50.0, {-between(0.7, 2.4), 0.5 * kDegree * box}, {0.0, 0.1 * box});
    replay::Parameters truth = replay::nominal(e);
    const auto off = [&](const std::string& name, double halfWidth) {
        const double at = replay::get(truth, e, name).value();
        REQUIRE(replay::set(truth, e, name, at + between(-0.8, 0.8) * halfWidth).empty());
    };
    off("length", 0.02 * length);
    for (const char* run : {"_run1", "_run2"}) {
        off(std::string("release_angle") + run, 0.5 * kDegree);
        off(std::string("release_spin") + run, 0.1);
    }
    REQUIRE(replay::set(truth, e, "bearing_friction:torque_N_m", friction).empty());
    for (std::size_t r = 0; r < e.runs.size(); ++r) {
        e.runs[r].readings = replay::simulate(e, r, truth, replay::Resolution::fine()).readings;
        for (double& v : e.runs[r].readings.force)
            v += 0.1 * kDegree * random.normal();
    }
    return e;
}

/// A made-up weight on a spring with viscous damping, released twice.
experiment::Experiment oscillator(std::uint64_t seed, double box) {
    Random random(seed);
    const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
    const double frequency = between(0.7, 3.0), noise = 3e-4; // Hz, m
    experiment::Experiment e;
    e.protocol = experiment::Protocol::FreeScene;
    e.gravity = {0.0, 0.0};
    experiment::FreeScene s;
    s.file = "mass_on_spring.json";
    std::vector<scene::Problem> problems;
    s.text = scene::readFile(std::string(SC_SOURCE_DIR) + "/scenes/experiments/mass_on_spring.json", problems).value();
    s.parameters = {{"frequency", {frequency, 0.02 * box * frequency}, "Hz", ""}};
    s.observation.target = "weight";
    s.observation.quantity = scene::Observation::Quantity::Y;
    s.channel = {"y", "mm", "y_mm", 1e3, 1.0};
    s.zero.halfWidth = 1e-3 * box;
    e.scene = s;
    e.sensors.forceNoise = noise;
    for (int r = 0; r < 2; ++r) {
        experiment::Run run;
        run.file = "run_" + std::to_string(r + 1) + ".csv";
        run.driveTime = {0.0, 10.0 / frequency};
        run.driveDisplacement = {0.0, 0.0};
        run.samplingRate = 25.0 * frequency;
        run.parameters = {{"release_y", {between(0.03, 0.1), 2e-3 * box}, "m", ""},
                          {"release_vy", {0.0, 0.02 * box}, "m/s", ""}};
        e.runs.push_back(run);
    }
    replay::Parameters truth = replay::nominal(e);
    const auto off = [&](const std::string& name, double halfWidth) {
        const double at = replay::get(truth, e, name).value();
        REQUIRE(replay::set(truth, e, name, at + between(-0.8, 0.8) * halfWidth).empty());
    };
    off("frequency", 0.01 * frequency);
    for (const char* run : {"_run1", "_run2"}) {
        off(std::string("release_y") + run, 1e-3);
        off(std::string("release_vy") + run, 0.01);
    }
    const double viscous = between(0.003, 0.02) * 4.0 * M_PI * 0.5 * frequency; // of 0.5 kg and a share of the critical
    REQUIRE(replay::set(truth, e, "guide_friction:viscous_N_s_m", viscous).empty());
    for (std::size_t r = 0; r < e.runs.size(); ++r) {
        e.runs[r].readings = replay::simulate(e, r, truth, replay::Resolution::fine()).readings;
        for (double& v : e.runs[r].readings.force)
            v += noise * random.normal();
    }
    return e;
}

struct Count {
    int starts = 0, agreed = 0;
};

/// Fits from the stated numbers and from `starts` others; those within 2 of the
/// least chi-squared agree.
Count fitted(const experiment::Experiment& e, std::uint64_t seed, int starts, const std::string& label,
             const std::string& variant) {
    const ReplayModel model(e);
    const RecordedData data = recordedDataOf(e);
    SimulationCache cache;
    Evaluator evaluator(model, e.runs.size(), {}, cache);
    std::size_t friction = 0;
    while (friction < model.candidates().size() &&
           (model.candidates()[friction].label != label || model.candidates()[friction].variant != variant))
        ++friction;
    REQUIRE(friction < model.candidates().size());
    diagnosis::ParameterPoint stated;
    for (const Scalar& s : model.nominal())
        stated.nominal.push_back(s.value);
    stated.terms = {{friction, model.candidates()[friction].probes.front()}};
    const auto there = evaluator.simulateAllRuns({stated}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there);
    Random random(seed + 100);
    std::vector<double> ends;
    for (int i = 0; i < starts; ++i) {
        diagnosis::ParameterPoint at = stated;
        for (std::size_t k = 0; k < at.nominal.size() && i > 0; ++k) {
            const Scalar& s = model.nominal()[k];
            at.nominal[k] = s.lower + (s.upper - s.lower) * random.uniform();
        }
        ends.push_back(fit(evaluator, likelihood, at).chiSquared);
    }
    const double least = *std::min_element(ends.begin(), ends.end());
    UNSCOPED_INFO(e.scene->file << " " << seed << ": least " << least);
    return {starts,
            static_cast<int>(std::count_if(ends.begin(), ends.end(), [&](double c) { return c < least + 2.0; }))};
}

} // namespace

TEST_CASE("a pendulum is fitted from every start in its box", "[diagnosis][free]") {
    for (const double box : {0.5, 3.0}) {
        const Count c = fitted(pendulum(1, box), 1, 3, "bearing_friction", "dry");
        CHECK(c.agreed == c.starts);
    }
}

TEST_CASE("pendulums and oscillators are fitted from every start in their boxes", "[diagnosis][free][slow]") {
    Count all;
    for (std::uint64_t seed = 1; seed <= 6; ++seed)
        for (const double box : {0.5, 1.0, 3.0, 10.0})
            for (const bool turns : {true, false}) {
                const Count c = turns ? fitted(pendulum(seed, box), seed, 10, "bearing_friction", "dry")
                                      : fitted(oscillator(seed, box), seed, 10, "guide_friction", "viscous");
                UNSCOPED_INFO((turns ? "pendulum " : "oscillator ") << seed << ", box " << box << ": " << c.agreed);
                all.starts += c.starts;
                all.agreed += c.agreed;
            }
    CHECK(all.agreed >= 0.98 * all.starts);
}
