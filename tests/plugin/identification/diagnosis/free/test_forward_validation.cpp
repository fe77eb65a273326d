// Free runs are held out forward in time, and a law whose forecast fails is not named.

#include "plugin/identification/diagnosis/result/verdict.h"
#include "plugin/identification/diagnosis/selection/forward_validation.h"
#include "tests/plugin/identification/diagnosis/free/swing.h"

#include <catch2/catch.hpp>
#include <memory>

using namespace supercircle::diagnosis;

namespace {

/// The forecast of one run by a label fitted to all of it.
struct Forecasted {
    Forecasted(const RecordedData& data, const std::string& label) : model(data, 0.05), evaluator(model, 1, {}, cache) {
        ParameterPoint at;
        for (const Scalar& s : model.nominal())
            at.nominal.push_back(s.value);
        for (std::size_t c = 0; c < model.candidates().size(); ++c)
            if (model.candidates()[c].label == label)
                at.terms = {{c, {0.1}}};
        const auto there = evaluator.simulateAllRuns({at}, Fidelity::Fine).front();
        likelihood = std::make_unique<Likelihood>(data, estimateNoise(data), there, there);
        const Grouping grouping = groupingOf(*likelihood);
        score = crossValidate(evaluator, *likelihood, grouping, fit(evaluator, *likelihood, at));
        run = forecastsOf(*likelihood, grouping, score, 1).front();
    }
    swing::Oscillator model;
    SimulationCache cache;
    Evaluator evaluator;
    std::unique_ptr<Likelihood> likelihood;
    PredictiveScore score;
    RunForecast run;
};

} // namespace

TEST_CASE("a free run is forecast by its own law and by no other", "[diagnosis][free]") {
    const RecordedData data = swing::recording(1, 1.02, 0.15, 20.0);
    const Forecasted own(data, "quadratic"), other(data, "viscous");
    CHECK(own.score.folds == 3);
    CHECK(own.score.substituted == 0);
    CHECK(other.score.substituted == 0);
    // Two thirds of 500 rows are forecast; the mean of their squares scatters by sqrt(2 / 333) = 0.08.
    CHECK(own.score.rows.sum() == Approx(333.0).margin(2.0));
    CHECK(own.run.squares == Approx(1.0).margin(0.3));
    CHECK(own.run.holds);
    CHECK(other.run.atLeast > 1.35);
    CHECK_FALSE(other.run.holds);
}

TEST_CASE("an effect whose forecast fails is not identified", "[diagnosis][free]") {
    const RecordedData data = swing::recording(2, 1.02, 0.15, 20.0);
    const auto diagnosed = [&](bool quadratic) {
        const swing::Oscillator model(data, 0.05, quadratic);
        SimulationCache cache;
        Evaluator evaluator(model, 1, {}, cache);
        DiagnosisSettings settings;
        settings.draws = 199;
        return diagnose(data, evaluator, settings);
    };
    const Diagnosis right = diagnosed(true);
    INFO(right.statement);
    CHECK(right.verdict == "identified");
    REQUIRE(!right.effects.empty());
    CHECK(right.effects.front().label == "quadratic");
    CHECK(right.statement.find("The forecast does not hold") == std::string::npos);
    const Diagnosis wrong = diagnosed(false); // the true law is not in this catalogue
    INFO(wrong.statement);
    CHECK(wrong.verdict != "identified");
    CHECK(wrong.statement.find("The forecast does not hold for swing.csv") != std::string::npos);
    for (const FittedEffect& e : wrong.effects)
        CHECK(e.probability < 0.9);
    // No fit is beaten by a replay with the stated numbers and its law. Errors are about the mean of their differences.
    const swing::Oscillator model(data, 0.05);
    for (const Diagnosis* d : {&right, &wrong})
        for (const FittedEffect& e : d->effects) {
            ParameterPoint stated{{model.nominal()[0].value, model.nominal()[1].value}, {}};
            for (std::size_t c = 0; c < model.candidates().size(); ++c)
                if (model.candidates()[c].label == e.label)
                    stated.terms = {{c, {e.parameters.front().value}}};
            const Eigen::VectorXd left = data.runs[0].force - model.simulate(0, stated, Fidelity::Fine, nullptr).force;
            CHECK(e.trainingRmse < std::sqrt(left.squaredNorm() / static_cast<double>(left.size())) + 1e-9);
            CHECK(e.starts >= 2);
        }
}

TEST_CASE("a forecast that fails limits the verdict", "[diagnosis][free]") {
    Evidence e;
    e.p = 0.001;
    e.adequate = 0.0;
    e.any = true;
    e.groupProbability = 1.0;
    e.gain = 100.0;
    e.gainLow = 50.0;
    CHECK(verdictOf(e) == "identified");
    e.forecastHolds = false;
    CHECK(verdictOf(e) == "ambiguous");
    Evidence nothing;
    CHECK(verdictOf(nothing) == "adequate");
    nothing.forecastHolds = false;
    CHECK(verdictOf(nothing) == "inconclusive");
}
