#include "plugin/identification/diagnosis/carried_score.h"

#include "plugin/identification/diagnosis/estimation/baseline_fit.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/selection/hypothesis_search.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"

#include <algorithm>

namespace supercircle::diagnosis {

namespace {

struct Scored {
    FitResult fit;
    PredictiveScore held;
    double rmse = 0.0;
};

Scored scored(Evaluator& evaluator, const Likelihood& likelihood, FitResult fitted, const DiagnosisSettings& settings) {
    Scored out;
    out.held = predictiveScoreOf(evaluator, likelihood, groupingOf(likelihood), fitted, settings);
    out.rmse = forceRmse(likelihood, fitted.responses);
    out.fit = std::move(fitted);
    return out;
}

} // namespace

Result<replay::LawScore> scoreOfLaw(const experiment::Experiment& e, const std::vector<effects::Setting>& law,
                                    const std::atomic<bool>* interrupt) {
    using Failed = Result<replay::LawScore>;
    if (std::string why = tooFewReadings(e); !why.empty())
        return Failed::failure(std::move(why));
    const RecordedData data = recordedDataOf(e);
    const Noise noise = estimateNoise(data);
    if (noise.total() <= 0.0)
        return Failed::failure("the noise of these recordings is not known");
    const DiagnosisSettings settings;
    const auto quietly = [](double, const std::string&) {};
    try {
        ReplayModel with(e, {}, interrupt);
        with.fix(law);
        const ReplayModel without(e, {}, interrupt);
        SimulationCache cacheWith, cacheWithout;
        Evaluator carried(with, e.runs.size(), {}, cacheWith, interrupt);
        Evaluator stated(without, e.runs.size(), {}, cacheWithout, interrupt);
        BaselineFit before = fitBaseline(data, stated, noise, settings, quietly);
        if (!before.likelihood)
            return Failed::failure(before.failure.empty() ? "interrupted" : before.failure);
        BaselineFit after = fitBaseline(data, carried, noise, settings, quietly);
        if (!after.likelihood)
            return Failed::failure(after.failure.empty() ? "interrupted" : "with the law: " + after.failure);
        // Both are judged by one error model: that of the fit with the law, which is the nearer one if it is right.
        const Likelihood& likelihood = *after.likelihood;
        const Scored a = scored(stated, likelihood, fit(stated, likelihood, before.fit.point), settings);
        const Scored b = scored(carried, likelihood, std::move(after.fit), settings);
        const double dispersion =
            std::max(1.0, std::min(chiSquaredPerReading(likelihood, a.fit), chiSquaredPerReading(likelihood, b.fit)));
        const Eigen::VectorXd held = b.held.score(dispersion), heldWithout = a.held.score(dispersion);
        if (held.size() == 0 || held.size() != heldWithout.size())
            return Failed::failure("no readings can be left out");
        const Paired gain = paired(held, heldWithout);
        return replay::LawScore{a.rmse, b.rmse, a.held.forceRmse, b.held.forceRmse, gain.difference, gain.error};
    } catch (const Stopped&) {
        return Failed::failure("interrupted");
    }
}

} // namespace supercircle::diagnosis
