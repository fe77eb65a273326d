// Further runs of scenes that nothing drives: recorded for longer, or with another release.

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/model/random.h"
#include "plugin/identification/diagnosis/next_experiment.h"
#include "plugin/identification/diagnosis/next_experiment/candidate_runs.h"
#include "plugin/identification/diagnosis/next_experiment/competing_hypotheses.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/replay/simulate.h"
#include "tests/support/pendulum.h"

#include <algorithm>
#include <cmath>

using namespace supercircle;
using namespace supercircle::diagnosis;

namespace {

constexpr double kDegree = M_PI / 180.0, kNoise = 0.1; // rad; deg

/// A rod that is let go at these angles; no readings.
experiment::Experiment pendulum(const std::vector<double>& degrees, double seconds = 5.0) {
    experiment::Experiment e = test::pendulum({0.124, 0.003});
    e.scene->zero.halfWidth = 0.1 * kDegree;
    e.sensors.forceNoise = kNoise * kDegree;
    for (const double angle : degrees)
        test::addSwing(e, seconds, 50.0, {angle * kDegree, 1.0 * kDegree}, {0.0, 0.05});
    return e;
}

void record(experiment::Experiment& e, std::size_t run, const replay::Parameters& truth, std::uint64_t seed) {
    Random random(seed);
    e.runs[run].readings = replay::simulate(e, run, truth, replay::Resolution::fine()).readings;
    for (double& v : e.runs[run].readings.force)
        v += kNoise * kDegree * random.normal();
}

/// Fits of laws to all runs.
struct Study {
    explicit Study(const experiment::Experiment& e)
        : model(e), data(recordedDataOf(e)), noise(estimateNoise(data)), evaluator(model, e.runs.size(), {}, cache) {
        const auto there = evaluator.simulateAllRuns({statedPoint(model)}, Fidelity::Fine).front();
        likelihood = std::make_unique<Likelihood>(data, noise, there, there);
    }
    FitResult fitted(const char* label, const char* variant) {
        ParameterPoint start = statedPoint(model);
        for (std::size_t c = 0; c < model.candidates().size(); ++c)
            if (model.candidates()[c].label == label && model.candidates()[c].variant == variant)
                start.terms.push_back({c, model.candidates()[c].probes.front()});
        REQUIRE(start.terms.size() == 1);
        FitResult out = fit(evaluator, *likelihood, start, {});
        REQUIRE(out.failure.empty());
        return out;
    }
    ReplayModel model;
    RecordedData data;
    Noise noise;
    SimulationCache cache;
    Evaluator evaluator;
    std::unique_ptr<Likelihood> likelihood;
};

} // namespace

TEST_CASE("a swing is proposed again for longer, and with other releases", "[diagnosis][free]") {
    const experiment::Experiment e = pendulum({-10.0, 25.0});
    const std::vector<CandidateRun> runs = candidateRunsFor(e);
    REQUIRE(runs.size() == 4); // once for longer, three releases of the wider one
    CHECK(runs[0].duration == Approx(15.0));
    for (const CandidateRun& run : runs) {
        INFO(run.description);
        CHECK(run.run == 1);
        CHECK(run.time.empty()); // nothing is driven
        CHECK(run.rate == 50.0);
    }
    const ReplayModel model(e);
    ParameterPoint point = statedPoint(model);
    for (std::size_t i = 0; i < point.nominal.size(); ++i)
        if (model.nominal()[i].name == "release_angle_run2")
            point.nominal[i] += 0.5 * kDegree; // what was found of the recorded one
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const CandidateRunResponse there = model.simulateCandidateRun(i, point, nullptr);
        REQUIRE(there.failure.empty());
        CHECK(there.force.size() == Approx(50.0 * runs[i].duration).margin(1.0));
        const double release = runs[i].changed.empty() ? 25.0 * kDegree : runs[i].changed.front().to;
        CHECK(there.force[0] == Approx(release / kDegree + 0.5).margin(1e-6)); // deg
    }
}

TEST_CASE("what a scene lets its runs say of themselves is varied, nothing else", "[diagnosis][free]") {
    experiment::Experiment e = pendulum({0.0});
    CHECK(candidateRunsFor(e).size() == 1); // at rest: three times nothing is nothing
    e.runs.front().parameters.push_back({"mass", {0.01, 0.0}, "kg", ""});
    const std::vector<CandidateRun> runs = candidateRunsFor(e);
    REQUIRE(runs.size() == 4);
    CHECK(runs[1].description.find("with mass 0.005 instead of 0.01 kg") != std::string::npos);
}

TEST_CASE("the next swing decides between two laws of friction as often as is said", "[diagnosis][free]") {
    // Small swings with much noise: air that resists with the square of the speed looks like a bearing that resists
    // with the speed.
    experiment::Experiment e = pendulum({12.0});
    replay::Parameters truth = replay::nominal(e);
    REQUIRE(replay::set(truth, e, "air_drag:quadratic_N_s2_m3", 4e-3).empty());
    record(e, 0, truth, 3);
    Study one(e);
    FittedHypothesis drag, bearing;
    drag.fit = one.fitted("air_drag", "quadratic");
    bearing.fit = one.fitted("bearing_friction", "viscous");
    const double before = bearing.fit.chiSquared - drag.fit.chiSquared;
    INFO("chi-squared before: " << before);
    CHECK(std::abs(before) < 9.0); // they compete
    const std::vector<CompetingHypothesis> competing =
        competingHypotheses(one.evaluator, *one.likelihood, drag.fit,
                            {{"air_drag", 0.5, &drag, true}, {"bearing_friction", 0.5, &bearing, true}}, {}, 0.0);
    const auto next = nextExperiment(one.evaluator, competing, one.noise, 0.0);
    REQUIRE(next);
    INFO(describeNext(*next));
    REQUIRE(next->expectedConclusive);
    int decided = 0;
    constexpr int kTries = 3;
    for (int k = 0; k < kTries; ++k) {
        experiment::Experiment both = e;
        Random random(static_cast<std::uint64_t>(k));
        for (const FurtherRun& further : next->runs)
            for (std::size_t n = 0; n < further.repeats; ++n) {
                const CandidateRun& run = further.candidateRun;
                const double release = run.changed.empty() ? 12.0 * kDegree : run.changed.front().to;
                test::addSwing(both, run.duration, run.rate, {release, 1.0 * kDegree}, {0.0, 0.05});
                const std::size_t last = both.runs.size() - 1;
                replay::Parameters there = replay::nominal(both);
                there.effects = truth.effects;
                const std::string own = "release_angle_run" + std::to_string(last + 1); // let go by hand
                REQUIRE(replay::set(there, both, own, release + (2.0 * random.uniform() - 1.0) * kDegree).empty());
                record(both, last, there, 100 * static_cast<std::uint64_t>(k) + last);
            }
        Study after(both);
        const double gain =
            after.fitted("bearing_friction", "viscous").chiSquared - after.fitted("air_drag", "quadratic").chiSquared;
        decided += gain > 25.0 ? 1 : 0; // the five sigma that are asked for
    }
    CHECK(decided == kTries);
}
