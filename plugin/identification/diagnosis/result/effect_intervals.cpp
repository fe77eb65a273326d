#include "plugin/identification/diagnosis/result/effect_intervals.h"

#include "plugin/identification/diagnosis/estimation/sandwich.h"
#include "plugin/identification/diagnosis/screening/local_minima.h"
#include "plugin/identification/diagnosis/selection/hypothesis_search.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"

#include <algorithm>
#include <utility>

namespace supercircle::diagnosis {

namespace {

/// Profile-likelihood intervals of a hypothesis. A better fit found by a profile or at another position on the arc
/// replaces it.
/// @param careful its derivatives, output
std::vector<Interval> profiled(const IntervalSearch& s, FittedHypothesis& t, Eigen::MatrixXd& careful) {
    constexpr int kMoves = 2;
    constexpr double kSmallestGain = 1.0; // delta chi-squared that justifies a move to another position
    std::vector<FitResult> elsewhere;     // at other positions on the arc
    std::vector<Interval> intervals;
    FitResult& f = t.fit;
    int moves = 0;
    for (;; ++moves) {
        const bool mayMove = moves < kMoves && !s.evaluator.stopped();
        const Variables here(s.evaluator.model(), f.point);
        careful = differentiateRobustly(s.evaluator, s.likelihood, here, f.x, 0.2);
        const Eigen::VectorXd dispersions =
            dispersionsOf(s.likelihood, here, f.residual, careful, chiSquaredPerReading(s.likelihood, f));
        Profiled p = profileIntervals(s.evaluator, s.likelihood, f, careful, dispersions, mayMove);
        if (p.better && !s.evaluator.stopped()) {
            FitResult further = fit(s.evaluator, s.likelihood, here.at(p.better->x));
            if (!further.failure.empty() || further.chiSquared > p.better->chiSquared)
                further = std::move(*p.better);
            further.point = here.at(further.x);
            f = std::move(further);
            continue;
        }
        if (elsewhere.empty())
            elsewhere = otherLocalMinima(s.evaluator, s.likelihood, f, s.screened, s.baselineChiSquared);
        const auto lowest =
            std::min_element(elsewhere.begin(), elsewhere.end(),
                             [](const FitResult& a, const FitResult& b) { return a.chiSquared < b.chiSquared; });
        if (mayMove && lowest != elsewhere.end() && lowest->chiSquared < f.chiSquared - kSmallestGain) {
            std::swap(f, *lowest);
            continue;
        }
        intervals = std::move(p.intervals);
        if (const FitResult* image = widenByLocalMinima(elsewhere, s.evaluator.model(), f, dispersions, intervals))
            t.mirrorImage = *image;
        break;
    }
    if (moves > 0 && !s.evaluator.stopped()) // held-out errors belong to the fit that is shown
        t.held = usable(predictiveScoreOf(s.evaluator, s.likelihood, s.grouping, f, s.settings), s.baselineScore);
    return intervals;
}

} // namespace

std::vector<Interval> linearIntervals(const Likelihood& likelihood, const Model& model, const FitResult& f,
                                      const Eigen::MatrixXd& jacobian) {
    const Variables v(model, f.point);
    return linearIntervals(v, f, jacobian,
                           dispersionsOf(likelihood, v, f.residual, jacobian, chiSquaredPerReading(likelihood, f)));
}

ParameterIntervals carefulIntervals(const IntervalSearch& s, bool profiles, FittedHypothesis& hypothesis) {
    const FitResult& f = hypothesis.fit;
    ParameterIntervals out;
    Eigen::MatrixXd careful;
    if (profiles) {
        out.intervals = profiled(s, hypothesis, careful);
    } else {
        careful = differentiateRobustly(s.evaluator, s.likelihood, Variables(s.evaluator.model(), f.point), f.x, 0.2);
        out.intervals = linearIntervals(s.likelihood, s.evaluator.model(), f, careful);
    }
    const std::vector<CandidateEffect>& all = s.evaluator.model().candidates();
    const Variables v(s.evaluator.model(), f.point);
    Eigen::Index first = v.nominal;
    for (const std::size_t c : hypothesis.candidates) {
        out.derived.emplace_back();
        for (const DerivedQuantity& p : all[c].derived)
            out.derived.back().push_back(derivedInterval(s.evaluator, s.likelihood, f, careful, p, first));
        first += static_cast<Eigen::Index>(all[c].parameters.size());
    }
    return out;
}

} // namespace supercircle::diagnosis
