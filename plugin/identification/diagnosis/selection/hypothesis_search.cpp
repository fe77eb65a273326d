#include "plugin/identification/diagnosis/selection/hypothesis_search.h"

#include "plugin/identification/diagnosis/selection/fit_learned_laws.h"
#include "plugin/identification/diagnosis/selection/law_variants.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"
#include "plugin/identification/diagnosis/selection/two_effect_hypotheses.h"

#include <algorithm>
#include <set>

namespace supercircle::diagnosis {

namespace {

/// Share of the held-out misfit that an effect may leave before laws are learned.
constexpr double kResidualShare = 0.05;

/// Stated numbers that are fitted as wrong ones. One more costs a fit where that many stand at the ends of their
/// intervals; one less misses the wrong one where three change the readings alike.
constexpr std::size_t kNumbers = 3;

class HypothesisSearch {
public:
    HypothesisSearch(const SearchInput& input, const std::function<void(double, const std::string&)>& stage)
        : input_(input), stage_(stage) {}

    SearchResult run() {
        const std::vector<RankedProbes> ranked = promising();
        for (std::size_t i = 0; i < ranked.size(); ++i) {
            stage_(0.35 + 0.55 * static_cast<double>(i) / static_cast<double>(ranked.size()),
                   "fitting " + labelOf(*ranked[i].front()));
            if (isAside(ranked[i]) && explained())
                break;
            if (!stop().attempt([&] { tryLabel(ranked[i]); }))
                out_.notTried.push_back("the effect " + plainWords(labelOf(*ranked[i].front())));
        }
        // At least two hypotheses are kept, further ones only if they are close.
        std::stable_sort(
            out_.hypotheses.begin(), out_.hypotheses.end(),
            [](const FittedHypothesis& a, const FittedHypothesis& b) { return a.fit.chiSquared < b.fit.chiSquared; });
        while (out_.hypotheses.size() > 2 && out_.hypotheses.back().fit.chiSquared > 3.0 * least_)
            out_.hypotheses.pop_back();
        dropInactive();
        for (FittedHypothesis& t : out_.hypotheses)
            if (!stopped())
                t.held = scored(t.fit);
        if (!stop().attempt([&] { extendSearch(); }))
            out_.notTried.insert(out_.notTried.end(), furtherParts.begin() + done_, furtherParts.end());
        return std::move(out_);
    }

private:
    [[nodiscard]] const StopToken& stop() const { return input_.evaluator.stop(); }
    [[nodiscard]] bool stopped() const { return stop().stopped(); }
    [[nodiscard]] const std::string& labelOf(const ScreenedProbe& s) const {
        return input_.evaluator.model().candidates()[s.candidate].label;
    }
    [[nodiscard]] PredictiveScore scored(const FitResult& f) const {
        return usable(predictiveScoreOf(input_.evaluator, input_.likelihood, input_.grouping, f, input_.settings),
                      input_.baselineScore);
    }
    [[nodiscard]] std::vector<RankedProbes> promising() const;
    [[nodiscard]] bool ofNumber(const RankedProbes& probes) const;
    [[nodiscard]] bool isAside(const RankedProbes& probes) const;
    [[nodiscard]] bool explained() const;
    void tryLabel(const RankedProbes& probes);
    void dropInactive();
    void extendSearch();
    void tryVariants(double dispersion);
    void refitBest(double dispersion);
    void rankAndLocalise(double dispersion);
    [[nodiscard]] bool residualTooLarge() const;
    [[nodiscard]] bool pairsCanCount(double dispersion) const;
    void tryPairs();
    [[nodiscard]] bool numbersCanCount() const;
    void tryNumbers();
    void refitParts(const FittedHypothesis& pair);
    void tryLearned(double left);
    void rank(double dispersion);

    const SearchInput& input_;
    const std::function<void(double, const std::string&)>& stage_;
    SearchResult out_;
    std::set<std::size_t> fitted_; ///< candidates already fitted
    double least_ = 0.0;           ///< smallest chi-squared so far
    /// What extends the search, in its order.
    const std::vector<std::string> furtherParts{"other variants of the best laws",
                                                "the best laws from the stated parameters", "two effects at a time",
                                                "two stated numbers at a time", "learned laws"};
    std::ptrdiff_t done_ = 0; ///< how many of them
};

std::vector<RankedProbes> HypothesisSearch::promising() const {
    // 8 is a p-value of half a per cent for one parameter.
    const std::vector<RankedProbes> ranked = byLabel(input_.evaluator.model(), input_.screened, 8.0);
    // The best first: fits after a good one end early. Stated numbers take no place of an effect. The linear screening
    // may be wrong, but not by a factor of thirty.
    std::vector<RankedProbes> kept;
    std::size_t numbers = 0, effects = 0;
    for (const RankedProbes& r : ranked)
        if (ofNumber(r) ? numbers++ < kNumbers
                        : effects < 3 || (effects < input_.settings.fits &&
                                          r.front()->gain >= ranked.front().front()->gain / 30.0)) {
            effects += ofNumber(r) ? 0 : 1;
            kept.push_back(r);
        }
    std::stable_partition(kept.begin(), kept.end(), [&](const RankedProbes& r) { return !isAside(r); });
    return kept;
}

bool HypothesisSearch::ofNumber(const RankedProbes& probes) const {
    return input_.evaluator.model().candidates()[probes.front()->candidate].isNumber();
}

/// A number that the fit of free runs has left inside its interval, perhaps because it is out of phase.
bool HypothesisSearch::isAside(const RankedProbes& probes) const {
    const std::ptrdiff_t at = input_.evaluator.model().candidates()[probes.front()->candidate].number;
    return at >= 0 && std::abs(input_.base.x[at]) < kEndOfInterval;
}

/// Whether a fit leaves noise alone.
bool HypothesisSearch::explained() const {
    constexpr double kNoise = 1.2; // chi-squared per reading, as for pairs
    return least_ > 0.0 && least_ < kNoise * static_cast<double>(input_.likelihood.countedRows());
}

void HypothesisSearch::tryLabel(const RankedProbes& probes) {
    auto best = fitLabel(input_.evaluator, input_.likelihood, input_.base, probes, least_, fitted_);
    if (best && !stopped() && best->fit.chiSquared <= input_.base.chiSquared - 1.0)
        out_.hypotheses.push_back(std::move(*best));
}

/// Removes laws below their threshold, which change no reading. Their gain comes from better nominal parameters.
void HypothesisSearch::dropInactive() {
    constexpr double kActs = 1.0; // sigma, all readings together
    for (auto t = out_.hypotheses.begin(); t != out_.hypotheses.end() && !stopped();) {
        ParameterPoint without = t->fit.point;
        without.terms.clear();
        const auto there = input_.evaluator.simulateAllRuns({without}, Fidelity::Fine).front();
        const auto changed = stopped() ? std::nullopt : input_.likelihood.whitenedDifference(t->fit.responses, there);
        if (!changed || changed->norm() >= kActs) {
            ++t;
            continue;
        }
        if (!out_.elsewhere || t->fit.chiSquared < out_.least) {
            out_.elsewhere = std::move(without);
            out_.least = t->fit.chiSquared;
        }
        t = out_.hypotheses.erase(t);
    }
}

/// Two effects and learned laws, where the best single effect leaves a residual.
void HypothesisSearch::extendSearch() {
    // All scores use one dispersion.
    double least = dispersionOf(input_.baselineScore);
    for (const FittedHypothesis& t : out_.hypotheses)
        least = std::min(least, dispersionOf(t.held));
    const double dispersion = std::max(1.0, least);
    rank(dispersion);
    const double bound = noiseBound(input_.baselineScore.rows.sum(), input_.excessKurtosis, input_.noiseChiSquared),
                 excess = dispersionOf(input_.baselineScore) - 1.0;
    const auto share = [&](const FittedHypothesis& t) {
        const double beyond = dispersionOf(t.held) - bound;
        return excess > 0.0 ? std::max(0.0, beyond) / excess : beyond > 0.0 ? 1.0 : 0.0;
    };
    double left = 1.0;
    if (!out_.hypotheses.empty()) {
        out_.residualAfterBest =
            localiseResidual(input_.evaluator, input_.likelihood, out_.hypotheses.front().fit, input_.settings);
        if (out_.residualAfterBest.p <= 0.01 && share(out_.hypotheses.front()) > kResidualShare)
            tryVariants(dispersion);
        done_ = 1;
        if (residualTooLarge())
            refitBest(dispersion);
        done_ = 2;
        left = share(out_.hypotheses.front());
        if (out_.residualAfterBest.p <= 0.01 && pairsCanCount(dispersion)) {
            const std::size_t singles = out_.hypotheses.size();
            tryPairs();
            for (std::size_t i = singles; i < out_.hypotheses.size(); ++i)
                left = std::min(left, share(out_.hypotheses[i]));
        }
    }
    done_ = 3;
    if (numbersCanCount()) {
        const std::size_t before = out_.hypotheses.size();
        tryNumbers();
        for (std::size_t i = before; i < out_.hypotheses.size(); ++i)
            left = std::min(left, share(out_.hypotheses[i]));
    }
    done_ = 4;
    if (input_.p <= 0.01 && left > kResidualShare && !input_.settings.ablation.openSet)
        tryLearned(left);
}

void HypothesisSearch::tryVariants(double dispersion) {
    stage_(0.78, "other variants of the best laws");
    for (std::size_t i = 0; i < out_.hypotheses.size() && i < 2; ++i) {
        FittedHypothesis& known = out_.hypotheses[i];
        auto better = betterVariant(input_.evaluator, input_.likelihood, input_.base, input_.screened, known, fitted_);
        if (!better || stopped())
            continue;
        better->held = scored(better->fit);
        if (better->held.score(dispersion).sum() > known.held.score(dispersion).sum())
            known = std::move(*better);
    }
    rankAndLocalise(dispersion);
}

/// Ranks the hypotheses and localises the residual of the best.
void HypothesisSearch::rankAndLocalise(double dispersion) {
    rank(dispersion);
    out_.residualAfterBest =
        localiseResidual(input_.evaluator, input_.likelihood, out_.hypotheses.front().fit, input_.settings);
}

/// Whether the best effect leaves more than a true one would.
bool HypothesisSearch::residualTooLarge() const {
    return diagnosis::leavesTooLargeResidual(input_.baselineScore, out_.hypotheses.front().held, input_.excessKurtosis,
                                             input_.noiseChiSquared, largestResidualZ(out_.residualAfterBest));
}

/// Refits the two best single effects from the stated values.
void HypothesisSearch::refitBest(double dispersion) {
    stage_(0.79, "the best laws from the stated parameters");
    bool any = false;
    for (std::size_t i = 0; i < out_.hypotheses.size() && i < 2 && !stopped(); ++i) {
        auto better = refitFromStated(input_.evaluator, input_.likelihood, out_.hypotheses[i]);
        if (!better || stopped())
            continue;
        better->held = scored(better->fit);
        out_.hypotheses[i] = std::move(*better);
        any = true;
    }
    if (any)
        rankAndLocalise(dispersion);
}

/// Whether the best single effect allows a second one, or its residual beyond noise could make a pair material. The
/// mean residual alone is not enough, because the noise of one channel may be overstated.
bool HypothesisSearch::pairsCanCount(double dispersion) const {
    const PredictiveScore& best = out_.hypotheses.front().held;
    if (allowsSecondEffect(input_.baselineScore, best, input_.excessKurtosis, input_.noiseChiSquared,
                           largestResidualZ(out_.residualAfterBest)))
        return true;
    const double rows = best.rows.sum(), floor = rows - 2.0 * std::sqrt(2.0 * rows);
    const double gain = best.score(dispersion).sum() - input_.baselineScore.score(dispersion).sum();
    return 0.5 * (best.energy.sum() - floor) / dispersion > kMaterial * gain;
}

void HypothesisSearch::tryPairs() {
    stage_(0.8, "two effects at a time");
    for (FittedHypothesis& t :
         fitTwoEffects(input_.evaluator, input_.likelihood, out_.hypotheses, input_.settings.probeShare())) {
        if (stopped())
            return;
        refitParts(t);
        t.held = scored(t.fit);
        out_.hypotheses.push_back(std::move(t));
    }
}

/// Whether physics explains what stated numbers might: a dent does what another height and another stiffness do.
bool HypothesisSearch::numbersCanCount() const {
    if (input_.p > 0.01 || out_.hypotheses.empty())
        return false;
    const std::vector<std::size_t>& best = out_.hypotheses.front().candidates;
    return std::any_of(best.begin(), best.end(),
                       [&](std::size_t c) { return !input_.evaluator.model().candidates()[c].isNumber(); });
}

void HypothesisSearch::tryNumbers() {
    stage_(0.83, "two stated numbers at a time");
    for (FittedHypothesis& t :
         fitTwoNumbers(input_.evaluator, input_.likelihood, input_.base, input_.screened, out_.hypotheses)) {
        if (stopped())
            return;
        t.held = scored(t.fit);
        out_.hypotheses.push_back(std::move(t));
    }
}

/// Refits the single effects of a pair from the pair: a pair must not count because its parts were fitted worse.
void HypothesisSearch::refitParts(const FittedHypothesis& pair) {
    for (const std::size_t k : pair.mustBeat) {
        FittedHypothesis& part = out_.hypotheses[k];
        FittedHypothesis again = part;
        ParameterPoint start = pair.fit.point;
        std::erase_if(start.terms, [&](const Term& t) { return t.candidate != part.candidates.front(); });
        if (start.terms.size() != 1 || stopped())
            continue;
        FitSettings given;
        given.competitor = part.fit.chiSquared;
        again.fit = fit(input_.evaluator, input_.likelihood, start, given);
        if (!again.fit.failure.empty() || stopped() || again.fit.chiSquared > part.fit.chiSquared - 1.0)
            continue;
        again.held = scored(again.fit);
        part = std::move(again);
    }
}

void HypothesisSearch::tryLearned(double left) {
    stage_(0.85, "learning a law");
    const std::size_t effects = out_.hypotheses.size();
    // More laws for a larger residual.
    for (FittedHypothesis& t : fitLearnedLaws(input_.evaluator, input_.likelihood, input_.base, left > 0.3 ? 3 : 2)) {
        if (stopped())
            return;
        t.held = scored(t.fit);
        for (std::size_t i = 0; i < effects; ++i)
            t.mustBeat.push_back(i);
        out_.hypotheses.push_back(std::move(t));
    }
}

void HypothesisSearch::rank(double dispersion) {
    std::stable_sort(out_.hypotheses.begin(), out_.hypotheses.end(),
                     [&](const FittedHypothesis& a, const FittedHypothesis& b) {
                         return a.held.score(dispersion).sum() > b.held.score(dispersion).sum();
                     });
}

} // namespace

PredictiveScore predictiveScoreOf(Evaluator& evaluator, const Likelihood& likelihood, const Grouping& grouping,
                                  const FitResult& fitted, const DiagnosisSettings& settings) {
    return settings.ablation.crossValidation ? inSampleScore(likelihood, grouping, fitted)
                                             : crossValidate(evaluator, likelihood, grouping, fitted);
}

Localisation localiseResidual(const Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                              const DiagnosisSettings& settings) {
    // Other draws than those of the baseline.
    return localise(likelihood, fitted.residual, freeColumns(evaluator.model(), fitted), settings.seed + 2,
                    settings.draws, {}, evaluator.stop());
}

SearchResult search(const SearchInput& input, const std::function<void(double, const std::string&)>& stage) {
    return HypothesisSearch(input, stage).run();
}

} // namespace supercircle::diagnosis
