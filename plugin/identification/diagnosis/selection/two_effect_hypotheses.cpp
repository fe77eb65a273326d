#include "plugin/identification/diagnosis/selection/two_effect_hypotheses.h"

#include "plugin/identification/diagnosis/selection/law_variants.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// A fit with fresh derivatives at its end.
FitResult withFreshDerivatives(Evaluator& evaluator, const Likelihood& likelihood, FitResult f) {
    const Variables v(evaluator.model(), f.point);
    std::vector<Index> all(static_cast<std::size_t>(v.size()));
    std::iota(all.begin(), all.end(), Index{0});
    differentiate(evaluator, likelihood, v, f.x, FitSettings{}.differenceStep, all, f.jacobian);
    return f;
}

} // namespace

std::vector<FittedHypothesis> fitTwoEffects(Evaluator& evaluator, const Likelihood& likelihood,
                                            const std::vector<FittedHypothesis>& singles, double share) {
    constexpr double kLeast = 12.0;               // delta chi-squared; smaller ones are chance
    constexpr double kWorth = 0.25;               // of the excess chi-squared of the first effect
    constexpr double kBehind = 3.0, kNoise = 1.2; // ratio to the best chi-squared; chi-squared per reading
    const Model& model = evaluator.model();
    const auto labelOf = [&](std::size_t candidate) -> const std::string& {
        return model.candidates()[candidate].label;
    };
    const auto actingOf = [&](std::size_t candidate) -> const std::string& {
        const CandidateEffect& c = model.candidates()[candidate];
        return c.acting.empty() ? c.label : c.acting;
    };
    std::vector<FittedHypothesis> pairs;
    std::set<std::pair<std::string, std::string>> known;
    double least = 0.0;
    for (std::size_t i = 0; i < singles.size() && i < 2 && !evaluator.stopped(); ++i) {
        const std::size_t candidate = singles[i].candidates.front();
        const std::string& first = labelOf(candidate);
        const FitResult base = withFreshDerivatives(evaluator, likelihood, singles[i].fit);
        const std::vector<ScreenedProbe> screened = screen(evaluator, likelihood, base, share);
        std::set<std::size_t> fitted;
        const double excess = base.chiSquared - static_cast<double>(likelihood.countedRows());
        std::size_t taken = 0;
        for (const RankedProbes& probes : byLabel(model, screened, kLeast)) {
            const std::string& second = labelOf(probes.front()->candidate);
            if (second == first || actingOf(probes.front()->candidate) == actingOf(candidate))
                continue;
            // The screening is linear. An effect that explains little of a large residual is not its cause, and one far
            // behind the best is not worth a fit.
            if (taken >= (i == 0 ? 2U : 1U) || evaluator.stopped() || probes.front()->gain < kWorth * excess ||
                (i > 0 && least > 0.0 && base.chiSquared - probes.front()->gain > kBehind * least))
                break;
            ++taken;
            if (!known.emplace(std::min(first, second), std::max(first, second)).second)
                continue;
            std::optional<FittedHypothesis> t = fitLabel(evaluator, likelihood, base, probes, least, fitted);
            if (!t)
                continue;
            t->candidates.insert(t->candidates.begin(), candidate);
            if (chiSquaredPerReading(likelihood, t->fit) > kNoise && !evaluator.stopped())
                if (auto better = refitFromStated(evaluator, likelihood, *t))
                    t = std::move(better);
            least = std::min(least, t->fit.chiSquared);
            for (std::size_t k = 0; k < singles.size(); ++k)
                if (const std::string& label = labelOf(singles[k].candidates.front());
                    label == first || label == second)
                    t->mustBeat.push_back(k);
            pairs.push_back(std::move(*t));
        }
    }
    return pairs;
}

} // namespace supercircle::diagnosis
