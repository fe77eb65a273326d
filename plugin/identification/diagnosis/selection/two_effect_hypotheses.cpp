#include "plugin/identification/diagnosis/selection/two_effect_hypotheses.h"

#include "plugin/identification/diagnosis/selection/law_variants.h"

#include <algorithm>
#include <cmath>
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

namespace {

/// Two numbers, and what they explain together.
struct NumberPair {
    const ScreenedProbe* probe[2] = {nullptr, nullptr};
    std::vector<double> factors;
    double gain = 0.0;
};

/// The best probe of each stated number at the end of its interval.
std::vector<const ScreenedProbe*> numbersAtEnds(const Model& model, const FitResult& base,
                                                const std::vector<ScreenedProbe>& screened) {
    std::vector<const ScreenedProbe*> numbers;
    for (const ScreenedProbe& s : screened) {
        const CandidateEffect& c = model.candidates()[s.candidate];
        if (!c.isNumber() || s.signature.size() == 0 || std::abs(base.x[c.number]) <= kEndOfInterval)
            continue;
        const auto known = std::find_if(numbers.begin(), numbers.end(),
                                        [&](const ScreenedProbe* n) { return n->candidate == s.candidate; });
        if (known == numbers.end())
            numbers.push_back(&s);
        else if (s.gain > (*known)->gain)
            *known = &s;
    }
    return numbers;
}

bool contains(const FittedHypothesis& t, const ScreenedProbe* number) {
    return std::find(t.candidates.begin(), t.candidates.end(), number->candidate) != t.candidates.end();
}

std::vector<NumberPair> rankedPairs(const Model& model, const FitResult& base,
                                    const std::vector<const ScreenedProbe*>& numbers) {
    const Variables v(model, base.point);
    std::vector<NumberPair> pairs;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            NumberPair p{{numbers[i], numbers[k]}, {}, 0.0};
            p.gain = explainTogether(
                base, v, {&model.candidates()[numbers[i]->candidate], &model.candidates()[numbers[k]->candidate]},
                {&numbers[i]->signature, &numbers[k]->signature}, p.factors);
            pairs.push_back(std::move(p));
        }
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const NumberPair& a, const NumberPair& b) { return a.gain > b.gain; });
    return pairs;
}

} // namespace

std::vector<FittedHypothesis> fitTwoNumbers(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& base,
                                            const std::vector<ScreenedProbe>& screened,
                                            const std::vector<FittedHypothesis>& others) {
    constexpr std::size_t kPairs = 2;
    const Model& model = evaluator.model();
    std::vector<FittedHypothesis> fitted;
    for (const NumberPair& p : rankedPairs(model, base, numbersAtEnds(model, base, screened))) {
        if (fitted.size() == kPairs || evaluator.stopped())
            break;
        const auto isFitted = [&](const FittedHypothesis& known) {
            return known.candidates.size() == 2 && contains(known, p.probe[0]) && contains(known, p.probe[1]);
        };
        if (std::any_of(others.begin(), others.end(), isFitted))
            continue;
        ParameterPoint start = base.point;
        FittedHypothesis t;
        for (std::size_t i = 0; i < 2; ++i) {
            const CandidateEffect& c = model.candidates()[p.probe[i]->candidate];
            start.terms.push_back({p.probe[i]->candidate, scaledValues(c, c.probes[p.probe[i]->probe], p.factors[i])});
            t.candidates.push_back(p.probe[i]->candidate);
        }
        t.fit = fit(evaluator, likelihood, start);
        if (!t.fit.failure.empty())
            continue;
        if (!evaluator.stopped())
            if (auto better = refitFromStated(evaluator, likelihood, t))
                t = std::move(better.value());
        for (std::size_t k = 0; k < others.size(); ++k)
            if (others[k].candidates.size() == 1 &&
                (contains(others[k], p.probe[0]) || contains(others[k], p.probe[1])))
                t.mustBeat.push_back(k);
        fitted.push_back(std::move(t));
    }
    return fitted;
}

} // namespace supercircle::diagnosis
