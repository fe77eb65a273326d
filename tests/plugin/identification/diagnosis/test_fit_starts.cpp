// Fits of free runs end in one minimum, whatever the start and the width of the stated intervals.

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

/// A made-up pendulum with dry friction, released twice. Its true numbers lie inside the intervals, which are `box`
/// times the usual ones.
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

struct Count {
    int starts = 0, agreed = 0;
};

/// Fits from the stated numbers and from `starts` others; those within 2 of the least chi-squared agree.
Count fitted(std::uint64_t seed, double box, int starts) {
    const experiment::Experiment e = pendulum(seed, box);
    const ReplayModel model(e);
    const RecordedData data = recordedDataOf(e);
    SimulationCache cache;
    Evaluator evaluator(model, e.runs.size(), {}, cache);
    std::size_t friction = 0;
    while (model.candidates()[friction].label != "bearing_friction" || model.candidates()[friction].variant != "dry")
        ++friction;
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
    UNSCOPED_INFO("pendulum " << seed << ", box " << box << ": least " << least);
    return {starts,
            static_cast<int>(std::count_if(ends.begin(), ends.end(), [&](double c) { return c < least + 2.0; }))};
}

} // namespace

TEST_CASE("a pendulum is fitted from every start in its box", "[diagnosis][free]") {
    for (const double box : {0.5, 3.0}) {
        const Count c = fitted(1, box, 3);
        CHECK(c.agreed == c.starts);
    }
}
