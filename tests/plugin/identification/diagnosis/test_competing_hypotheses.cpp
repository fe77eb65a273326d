// Hypotheses that a further run has to discriminate.

#include "toy.h"

#include "plugin/identification/diagnosis/next_experiment/competing_hypotheses.h"
#include "plugin/identification/diagnosis/noise.h"

#include <catch2/catch.hpp>
#include <string>
#include <vector>

using namespace supercircle::diagnosis;

TEST_CASE("competing hypotheses include effects with nearly the same screening gain", "[diagnosis]") {
    RecordedData data = toy::recordings(3);
    const toy::Spring model(data); // a dashpot, a drift and a cubic spring
    toy::hide(data, model, {{1, {2e-3}}});
    SimulationCache cache;
    Evaluator evaluator(model, data.runs.size(), {}, cache);
    const ParameterPoint stated{{100.0, 0.1}, {}};
    const auto there = evaluator.simulateAllRuns({stated}, Fidelity::Fine).front();
    const Likelihood likelihood(data, estimateNoise(data), there, there, {});
    const FitResult base = fit(evaluator, likelihood, stated);
    std::vector<ScreenedProbe> screened = screen(evaluator, likelihood, base);
    REQUIRE(screened.size() == 3);
    FittedHypothesis drift;
    drift.candidates = {1};
    drift.fit = fit(evaluator, likelihood, ParameterPoint{base.point.nominal, {{1, {2e-3}}}});
    const std::vector<ReportedEffect> named = {{"drift", 0.6, &drift, true}};
    /// @param gains of the screening, delta chi-squared
    /// @param adequate probability of the baseline
    const auto asked = [&](const std::vector<double>& gains, double baseline) {
        for (std::size_t i = 0; i < screened.size(); ++i)
            screened[i].gain = gains[i];
        return competingHypotheses(evaluator, likelihood, base, named, screened, baseline);
    };
    const auto labels = [](const std::vector<CompetingHypothesis>& competing) {
        std::vector<std::string> out;
        for (const CompetingHypothesis& r : competing)
            out.push_back(r.label);
        return out;
    };
    // The fitted effect comes first with its probability; an effect six units of chi-squared behind the best is left
    // out.
    const std::vector<CompetingHypothesis> weak = asked({7.0, 12.0, 5.0}, 0.25);
    CHECK(labels(weak) == std::vector<std::string>{"drift", "dashpot", "no_missing_effect"});
    CHECK(weak[0].weight == 0.6);
    CHECK(weak[1].weight > 0.0);
    CHECK(weak[1].weight <= 0.6); // its gain is smaller, so its weight is not larger
    CHECK(weak[1].x.size() == weak[0].x.size());
    CHECK(labels(asked({12.0, 7.0, 9.0}, 0.25)) ==
          std::vector<std::string>{"drift", "dashpot", "cubic", "no_missing_effect"});
    // An effect far ahead of all others competes with the baseline only.
    CHECK(labels(asked({7.0, 50.0, 5.0}, 0.01)) == std::vector<std::string>{"drift", "no_missing_effect"});
    // Without a probable effect they are ordered by gain, the best one with weight one.
    const std::vector<CompetingHypothesis> none = asked({7.0, 12.0, 9.0}, 0.8);
    CHECK(labels(none) == std::vector<std::string>{"drift", "cubic", "dashpot", "no_missing_effect"});
    CHECK(none[0].weight == 1.0);
}
