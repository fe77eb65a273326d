#include "plugin/identification/diagnosis/next_experiment/competing_hypotheses.h"

#include "plugin/identification/diagnosis/selection/law_variants.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace supercircle::diagnosis {

namespace {

constexpr std::size_t kMostRivals = 4;
constexpr double kSmallestProbability = 0.02; ///< smallest probability that is worth a run

CompetingHypothesis hypothesisOf(const Model& model, const Likelihood& likelihood, const std::string& label,
                                 const FitResult& f, double weight) {
    return {label, f.point, f.x,
            posteriorCovariance(Variables(model, f.point), f.jacobian, chiSquaredPerReading(likelihood, f)), weight};
}

/// The most promising screened effects, fitted if necessary, with likelihood weights relative to the best one.
std::vector<CompetingHypothesis> promisingHypotheses(Evaluator& evaluator, const Likelihood& likelihood,
                                                     const FitResult& base, const std::vector<ReportedEffect>& reported,
                                                     const std::vector<ScreenedProbe>& screened) {
    constexpr double kFar = 6.0; // delta chi-squared: a factor of twenty
    const std::vector<CandidateEffect>& candidates = evaluator.model().candidates();
    std::vector<const ScreenedProbe*> best;
    for (const ScreenedProbe& s : screened)
        if (s.gain > 0.0 && !candidates[s.candidate].learned)
            best.push_back(&s);
    std::stable_sort(best.begin(), best.end(),
                     [](const ScreenedProbe* a, const ScreenedProbe* b) { return a->gain > b->gain; });
    std::vector<CompetingHypothesis> out;
    double least = std::numeric_limits<double>::infinity();
    for (const ScreenedProbe* s : best) {
        const std::string& label = candidates[s->candidate].label;
        if (out.size() == kMostRivals || s->gain < best.front()->gain - kFar || evaluator.stopped())
            break;
        if (std::any_of(out.begin(), out.end(), [&](const CompetingHypothesis& r) { return r.label == label; }))
            continue;
        const auto known = std::find_if(reported.begin(), reported.end(), [&](const ReportedEffect& n) {
            return n.label == label && n.hypothesis->candidates.size() == 1;
        });
        const FittedHypothesis t =
            known != reported.end() ? *known->hypothesis : fitProbe(evaluator, likelihood, base, *s, 0.0);
        if (!t.fit.failure.empty())
            continue;
        least = std::min(least, t.fit.chiSquared);
        out.push_back(hypothesisOf(evaluator.model(), likelihood, label, t.fit, t.fit.chiSquared));
    }
    for (CompetingHypothesis& r : out)
        r.weight = math::exp(0.5 * (least - r.weight));
    return out;
}

} // namespace

std::vector<CompetingHypothesis> competingHypotheses(Evaluator& evaluator, const Likelihood& likelihood,
                                                     const FitResult& base, const std::vector<ReportedEffect>& reported,
                                                     const std::vector<ScreenedProbe>& screened, double adequate) {
    std::vector<CompetingHypothesis> out;
    std::set<const FittedHypothesis*> used; // effects of one model are one hypothesis
    for (std::size_t i = 0; i < reported.size() && out.size() < kMostRivals && adequate < 0.5; ++i) {
        const ReportedEffect& n = reported[i];
        if ((n.confounded || n.probability >= kSmallestProbability) && used.insert(n.hypothesis).second)
            out.push_back(hypothesisOf(evaluator.model(), likelihood, n.label, n.hypothesis->fit,
                                       std::max(kSmallestProbability, n.probability)));
    }
    // The mirror image of the first one, if its sign is ambiguous.
    if (!out.empty() && reported.front().hypothesis->mirrorImage) {
        out.front().weight *= 0.5;
        out.push_back(hypothesisOf(evaluator.model(), likelihood, reported.front().label,
                                   *reported.front().hypothesis->mirrorImage, out.front().weight));
        out.back().mirrorImage = true;
    }
    const double first = out.empty() ? 1.0 : out.front().weight;
    if (out.size() < kMostRivals)
        for (CompetingHypothesis& r : promisingHypotheses(evaluator, likelihood, base, reported, screened)) {
            const bool known =
                std::any_of(out.begin(), out.end(), [&](const CompetingHypothesis& o) { return o.label == r.label; });
            if (known || out.size() == kMostRivals)
                continue;
            r.weight *= first;
            out.push_back(std::move(r));
        }
    if (out.size() == 1 || (!out.empty() && adequate >= kSmallestProbability))
        out.push_back(hypothesisOf(evaluator.model(), likelihood, "no_missing_effect", base, 0.0));
    return out;
}

} // namespace supercircle::diagnosis
