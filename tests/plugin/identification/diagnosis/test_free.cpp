// Free mechanisms: synthetic recordings with known bearing friction and drag, and a real pendulum if its recordings are
// present.

#include "plugin/identification/diagnosis/carried_score.h"
#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/localisation/windows.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/selection/law_variants.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/scene/loader/document.h"
#include "tests/support/folder.h"
#include "tests/support/pendulum.h"

#include <cmath>
#include <numeric>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

constexpr double kRadiansInDegree = 3.14159265358979323846 / 180.0;

/// A rod released at three angles; readings are empty.
experiment::Experiment pendulum() {
    experiment::Experiment e = test::pendulum({0.124, 0.003});
    e.scene->zero.halfWidth = 0.5 * kRadiansInDegree;
    e.sensors.forceNoise = 0.1 * kRadiansInDegree;
    for (const double angle : {-60.0, -110.0, -150.0})
        test::addSwing(e, 4.0, 100.0, {angle * kRadiansInDegree, 0.3 * kRadiansInDegree}, {0.0, 0.2});
    return e;
}

/// Records the runs: `truth` simulated, with an encoder of .09 degrees and white noise.
void record(experiment::Experiment& e, const replay::Parameters& truth, std::uint64_t seed) {
    Random random(seed);
    for (std::size_t r = 0; r < e.runs.size(); ++r) {
        e.runs[r].readings = replay::simulate(e, r, truth, replay::Resolution::fine()).readings;
        for (double& v : e.runs[r].readings.force)
            v = 0.09 * kRadiansInDegree * std::round((v / kRadiansInDegree + 0.08 * random.normal()) / 0.09);
    }
}

std::size_t candidate(const Model& model, const std::string& label, const std::string& form) {
    for (std::size_t i = 0; i < model.candidates().size(); ++i)
        if (model.candidates()[i].label == label && model.candidates()[i].variant == form)
            return i;
    FAIL("no candidate " << label << ", " << form);
    return 0;
}

/// Fits the nominal parameters and these effects to all runs.
struct Study {
    Study(const experiment::Experiment& e, std::vector<std::pair<const char*, const char*>> effects)
        : model(e), data(recordedDataOf(e)), evaluator(model, e.runs.size(), {}, cache) {
        diagnosis::ParameterPoint start;
        for (const Scalar& s : model.nominal())
            start.nominal.push_back(s.value);
        for (const auto& [label, form] : effects) {
            const std::size_t c = candidate(model, label, form);
            start.terms.push_back({c, model.candidates()[c].probes.front()});
        }
        const auto there = evaluator.simulateAllRuns({start}, Fidelity::Fine).front();
        likelihood = std::make_unique<Likelihood>(data, estimateNoise(data), there, there);
        FitSettings settings;
        settings.iterations = 30;
        fitted = fit(evaluator, *likelihood, start, settings);
    }
    /// Of run r, degrees.
    [[nodiscard]] double rmse(std::size_t r) const {
        return std::sqrt((data.runs[r].force - fitted.responses[r].force).squaredNorm() /
                         static_cast<double>(data.runs[r].force.size()));
    }
    ReplayModel model;
    RecordedData data;
    SimulationCache cache;
    Evaluator evaluator;
    std::unique_ptr<Likelihood> likelihood;
    FitResult fitted;
};

} // namespace

TEST_CASE("dry friction and quadratic drag of a pendulum are recovered", "[diagnosis][free]") {
    experiment::Experiment e = pendulum();
    replay::Parameters truth = replay::nominal(e);
    REQUIRE(replay::set(truth, e, "length", 0.1225).empty());
    REQUIRE(replay::set(truth, e, "release_spin_run2", 0.1).empty());
    REQUIRE(replay::set(truth, e, "bearing_friction:torque_N_m", 1.5e-4).empty());
    REQUIRE(replay::set(truth, e, "air_drag:quadratic_N_s2_m3", 8e-3).empty());
    record(e, truth, 5);
    const Study both(e, {{"bearing_friction", "dry"}, {"air_drag", "quadratic"}});
    REQUIRE(both.fitted.failure.empty());
    // Noise of 0.08 degrees in 1200 rows: about 1e-3 of the effect of friction and drag.
    CHECK(both.fitted.point.terms[0].values[0] == Approx(1.5e-4).epsilon(0.01));
    CHECK(both.fitted.point.terms[1].values[0] == Approx(8e-3).epsilon(0.01));
    CHECK(both.fitted.point.nominal[0] == Approx(0.1225).epsilon(1e-4));
    for (std::size_t r = 0; r < 3; ++r)
        CHECK(both.rmse(r) == Approx(std::hypot(0.08, 0.09 / std::sqrt(12.0))).epsilon(0.1));
    const Study dry(e, {{"bearing_friction", "dry"}});
    CHECK(dry.fitted.chiSquared > 20.0 * both.fitted.chiSquared); // one of the two is not enough
    for (const WindowRows& spot : windowsOf(*dry.likelihood))
        CHECK(spot.window.channel == "angle"); // no force is read
}

TEST_CASE("a law that is carried to another specimen is scored on what is left out", "[diagnosis][free]") {
    experiment::Experiment e = pendulum();
    e.runs.pop_back();
    replay::Parameters truth = replay::nominal(e);
    REQUIRE(replay::set(truth, e, "length", 0.1225).empty());
    REQUIRE(replay::set(truth, e, "air_drag:quadratic_N_s2_m3", 8e-3).empty());
    record(e, truth, 6);
    const auto score = scoreOfLaw(e, truth.effects, nullptr);
    INFO(score.error());
    REQUIRE(score);
    // Noise of 0.084 degrees, and the clocks of recording and simulation may differ by a thousandth of a second.
    CHECK(score->heldOutWith < 0.25);
    CHECK(score->heldOutWithout > 20.0 * score->heldOutWith);
    CHECK(score->gain > 0.0);
    replay::Parameters wrong = truth;
    REQUIRE(replay::set(wrong, e, "air_drag:quadratic_N_s2_m3", 24e-3).empty());
    const auto other = scoreOfLaw(e, wrong.effects, nullptr);
    REQUIRE(other);
    CHECK(other->heldOutWith > 20.0 * score->heldOutWith);
    CHECK(other->gain < 0.1 * score->gain);
}

TEST_CASE("a pendulum fit converges to one minimum from every start", "[diagnosis][free][slow]") {
    // As for the real pendulum, bounds are wide and a residual remains. A fit without friction pushes initial speeds,
    // zero and length into corners. The phase is very sensitive to the initial speed, so derivatives must be refreshed
    // there.
    experiment::Experiment e = pendulum();
    e.scene->parameters[0].stated.halfWidth = 0.006;
    e.scene->zero.halfWidth = kRadiansInDegree;
    for (experiment::Run& run : e.runs)
        run.parameters[1].stated.halfWidth = 1.5;
    replay::Parameters truth = replay::nominal(e);
    REQUIRE(replay::set(truth, e, "length", 0.122).empty());
    REQUIRE(replay::set(truth, e, "release_spin_run1", -0.6).empty());
    REQUIRE(replay::set(truth, e, "release_spin_run3", -0.4).empty());
    REQUIRE(replay::set(truth, e, "bearing_friction:torque_N_m", 2e-4).empty());
    REQUIRE(replay::set(truth, e, "air_drag:quadratic_N_s2_m3", 8e-3).empty()); // which friction cannot explain
    record(e, truth, 8);
    const Study stated(e, {{"bearing_friction", "dry"}});
    diagnosis::ParameterPoint corner = stated.fitted.point;
    for (std::size_t i = 0; i < corner.nominal.size(); ++i)
        corner.nominal[i] = i % 2 == 0 ? stated.model.nominal()[i].upper : stated.model.nominal()[i].lower;
    SimulationCache cache;
    Evaluator evaluator(stated.model, e.runs.size(), {}, cache);
    constexpr double kAlike = 5.0; // chi-squared
    CHECK(fit(evaluator, *stated.likelihood, corner).chiSquared == Approx(stated.fitted.chiSquared).margin(kAlike));
    FittedHypothesis lost;
    lost.candidates = {corner.terms[0].candidate};
    lost.fit.point = corner;
    lost.fit.chiSquared = 1e3 * stated.fitted.chiSquared;
    const auto again = refitFromStated(evaluator, *stated.likelihood, lost);
    REQUIRE(again);
    CHECK(again->fit.chiSquared == Approx(stated.fitted.chiSquared).margin(kAlike));
}

TEST_CASE("a long free run is fitted", "[diagnosis][free]") {
    experiment::Experiment e = pendulum();
    for (experiment::Run& run : e.runs) {
        run.driveTime.back() = 40.0; // more steps than any driven run of that length takes
        run.samplingRate = 10.0;
    }
    record(e, replay::nominal(e), 7);
    const ReplayModel model(e);
    diagnosis::ParameterPoint nominal;
    for (const Scalar& s : model.nominal())
        nominal.nominal.push_back(s.value);
    for (const Fidelity f : {Fidelity::Fine, Fidelity::Coarse})
        CHECK(model.simulate(0, nominal, f, nullptr).failure == "");
}

TEST_CASE("segments of a free run are half oscillations", "[diagnosis][free]") {
    experiment::Experiment e = pendulum();
    record(e, replay::nominal(e), 6);
    const RecordedData data = recordedDataOf(e);
    CHECK(data.unit == "deg");
    for (const RecordedRun& run : data.runs) {
        REQUIRE(run.segments.size() >= 7);
        for (std::size_t l = 1; l + 1 < run.segments.size(); ++l) { // at turning points the angle is extreme
            Eigen::Index k = 0;
            while (run.time[k] < run.segments[l].from - 1e-9)
                ++k;
            CHECK(std::abs(run.force[k]) == Approx(run.force.cwiseAbs().maxCoeff()).epsilon(0.02));
        }
    }
}
