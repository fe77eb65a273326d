#include "plugin/identification/diagnosis/selection/law_variants.h"

#include <algorithm>
#include <map>

namespace supercircle::diagnosis {

FittedHypothesis fitProbe(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& base,
                          const ScreenedProbe& probe, double competitor) {
    ParameterPoint start = base.point;
    start.terms.push_back({probe.candidate, bestAmplitudeValues(evaluator, likelihood, base, probe)});
    FitSettings given;
    given.competitor = competitor;
    FittedHypothesis t;
    t.candidates = {probe.candidate};
    t.fit = fit(evaluator, likelihood, start, given, base.jacobian);
    return t;
}

std::vector<RankedProbes> byLabel(const Model& model, const std::vector<ScreenedProbe>& screened, double least) {
    std::map<std::string, RankedProbes> labels;
    for (const ScreenedProbe& s : screened)
        if (s.simulated && s.gain > least)
            labels[model.candidates()[s.candidate].label].push_back(&s);
    std::vector<RankedProbes> ranked;
    for (auto& [label, probes] : labels) {
        std::stable_sort(probes.begin(), probes.end(),
                         [](const ScreenedProbe* a, const ScreenedProbe* b) { return a->gain > b->gain; });
        ranked.push_back(probes);
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const RankedProbes& a, const RankedProbes& b) { return a.front()->gain > b.front()->gain; });
    return ranked;
}

namespace {

RankedProbes startsOf(const RankedProbes& probes, bool allVariants) {
    const ScreenedProbe& first = *probes.front();
    RankedProbes starts = {&first};
    for (const ScreenedProbe* p : probes)
        if (starts.size() < 2 && p->candidate != first.candidate && p->gain > 0.3 * first.gain)
            starts.push_back(p);
    // The screening of a base out of phase is unreliable: all variants are tried where that is cheap.
    for (const ScreenedProbe* p : probes)
        if (allVariants && std::none_of(starts.begin(), starts.end(),
                                        [&](const ScreenedProbe* s) { return s->candidate == p->candidate; }))
            starts.push_back(p);
    if (probes.size() > 1 && starts.size() < 2 && probes[1]->gain > 0.3 * first.gain)
        starts.push_back(probes[1]);
    return starts;
}

/// Chi-squared plus two per parameter, to compare variants (H. Akaike, IEEE Trans. Autom. Control 19 (1974) 716).
double penalisedChiSquared(const FittedHypothesis& t) {
    return t.fit.chiSquared + 2.0 * static_cast<double>(t.fit.x.size());
}

/// The stated nominal parameters with the terms of a point.
ParameterPoint fromStated(const Model& model, ParameterPoint point) {
    point.nominal = statedPoint(model).nominal;
    return point;
}

/// Chi-squared within which two fits have found one minimum.
constexpr double kAgree = 2.0;

/// Fits a law of moving bodies from the stated numbers too, and keeps the better fit.
void fitFromStatedToo(Evaluator& evaluator, const Likelihood& likelihood, const ScreenedProbe& probe,
                      FittedHypothesis& t) {
    ParameterPoint start = fromStated(evaluator.model(), t.fit.point);
    start.terms.back().values = probe.values;
    FitResult other = fit(evaluator, likelihood, start);
    if (!other.failure.empty())
        return;
    t.starts = 2;
    t.agreed = std::abs(other.chiSquared - t.fit.chiSquared) < kAgree ? 2 : 1;
    if (other.chiSquared < t.fit.chiSquared)
        t.fit = std::move(other);
}

/// Whether a nominal parameter of a fit stands at an end of its interval.
bool inCorner(const Model& model, const FitResult& f) {
    return std::any_of(f.x.begin(), f.x.begin() + Variables(model, f.point).nominal,
                       [](double x) { return std::abs(x) > kEndOfInterval; });
}

/// Whether a law with the stated parameters is better than its fit.
bool statedIsBetter(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted) {
    const Variables v(evaluator.model(), fitted.point);
    FitResult stated;
    stated.x = v.of(fromStated(evaluator.model(), fitted.point));
    return evaluate(evaluator, likelihood, v, stated) && stated.chiSquared < fitted.chiSquared;
}

} // namespace

std::optional<FittedHypothesis> fitLabel(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& base,
                                         const RankedProbes& probes, double& least, std::set<std::size_t>& fitted) {
    std::optional<FittedHypothesis> best;
    for (const ScreenedProbe* s : startsOf(probes, likelihood.data().freeBodies())) {
        if (evaluator.stopped())
            break;
        fitted.insert(s->candidate);
        FittedHypothesis t = fitProbe(evaluator, likelihood, base, *s, likelihood.data().freeBodies() ? 0.0 : least);
        if (!t.fit.failure.empty())
            continue;
        if (likelihood.data().freeBodies())
            fitFromStatedToo(evaluator, likelihood, *s, t);
        least = least > 0.0 ? std::min(least, t.fit.chiSquared) : t.fit.chiSquared;
        if (!best || penalisedChiSquared(t) < penalisedChiSquared(*best))
            best = std::move(t);
    }
    // Ends of intervals imitate effects, and no step may lead out of there.
    if (best && !evaluator.stopped() &&
        (inCorner(evaluator.model(), base) || statedIsBetter(evaluator, likelihood, best->fit)))
        if (auto again = refitFromStated(evaluator, likelihood, *best)) {
            best = std::move(again);
            least = std::min(least, best->fit.chiSquared);
        }
    return best;
}

std::optional<FittedHypothesis> refitFromStated(Evaluator& evaluator, const Likelihood& likelihood,
                                                const FittedHypothesis& known) {
    FittedHypothesis again = known;
    const ParameterPoint start = fromStated(evaluator.model(), known.fit.point);
    FitSettings given;
    given.competitor = known.fit.chiSquared;
    again.fit = fit(evaluator, likelihood, start, given);
    if (again.fit.failure.empty() && known.starts > 0) {
        ++again.starts;
        again.agreed = again.fit.chiSquared < known.fit.chiSquared - kAgree   ? 1
                       : again.fit.chiSquared < known.fit.chiSquared + kAgree ? known.agreed + 1
                                                                              : known.agreed;
    }
    if (!again.fit.failure.empty() || again.fit.chiSquared > known.fit.chiSquared - 1.0)
        return std::nullopt;
    return again;
}

std::optional<FittedHypothesis> betterVariant(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& base,
                                              const std::vector<ScreenedProbe>& screened, const FittedHypothesis& known,
                                              std::set<std::size_t>& fitted) {
    const std::vector<CandidateEffect>& all = evaluator.model().candidates();
    std::map<std::size_t, const ScreenedProbe*> others; // best probe by candidate
    for (const ScreenedProbe& s : screened)
        if (s.simulated && all[s.candidate].label == all[known.candidates.front()].label &&
            fitted.count(s.candidate) == 0)
            if (const auto at = others.emplace(s.candidate, &s).first; s.gain > at->second->gain)
                at->second = &s;
    std::optional<FittedHypothesis> best;
    double least = penalisedChiSquared(known) - 1.0;
    for (const auto& [candidate, probe] : others) {
        if (evaluator.stopped())
            break;
        fitted.insert(candidate);
        FittedHypothesis t = fitProbe(evaluator, likelihood, base, *probe, known.fit.chiSquared);
        if (t.fit.failure.empty() && penalisedChiSquared(t) < least) {
            least = penalisedChiSquared(t);
            best = std::move(t);
        }
    }
    return best;
}

} // namespace supercircle::diagnosis
