#include "plugin/identification/diagnosis/selection/model_weights.h"

#include "plugin/identification/diagnosis/model/random.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

/// Share of the excess misfit that a true effect may leave. Two simulators leave 0 to 3 %, an imitation 31 % (decision
/// 0081).
constexpr double kTrueEffectShare = 0.1;

/// Largest window statistic of a true effect's residual, sigma (decision 0081).
constexpr double kTrueEffectZ = 8.0;

/// Noise variances per row, beyond the noise, that no true effect leaves.
constexpr double kTrueEffectExcess = 3.0;

/// Share of the misfit that two forms of one law may leave, 1 % of the amplitude. A tilted string called nonlinear
/// elasticity leaves 0.026; plasticity by another simulator leaves less than 1e-4, and p = 0.019. Half refuses laws
/// that another simulator has 0.7 % off; double lets 1.4 % pass.
constexpr double kSameLaw = 1e-4;

/// Prior factor of an effect at the end of its plausible range.
constexpr double kAtBoundPrior = 0.1;

Eigen::VectorXd outsideCatalogueScore(const PredictiveScore& baseline, double dispersion, double floor,
                                      const WeightingInput& given) {
    const double rows = std::max(1.0, baseline.rows.sum());
    floor *= noiseBound(rows, given.excessKurtosis, given.noiseChiSquared);
    const double toExplain = 0.5 * std::max(0.0, baseline.energy.sum() - floor * rows) / dispersion;
    const double cost = std::max(4.0 * math::log(std::max(2.0, rows)), 0.15 * toExplain);
    // With the uncertainty of the nominal parameters.
    return -(0.5 * floor / dispersion + cost / rows) * baseline.rows - 0.5 * baseline.volume;
}

} // namespace

double noiseBound(double rows, double excessKurtosis, double squares) {
    return std::max(1.1, squares) + 2.0 * std::sqrt((2.0 + excessKurtosis) / std::max(1.0, rows));
}

double dispersionOf(const PredictiveScore& h) {
    return h.rows.sum() > 0.0 ? h.energy.sum() / h.rows.sum() : 1.0;
}

bool leavesTooLargeResidual(const PredictiveScore& baseline, const PredictiveScore& effect, double excessKurtosis,
                            double noiseChiSquared, double largestZ) {
    const double excess = dispersionOf(baseline) - 1.0, left = dispersionOf(effect) - 1.0;
    const double bound = noiseBound(baseline.rows.sum(), excessKurtosis, noiseChiSquared) - 1.0;
    return (left > bound && left - bound > kTrueEffectShare * (excess - bound)) || left > kTrueEffectExcess ||
           largestZ > kTrueEffectZ;
}

bool allowsSecondEffect(const PredictiveScore& baseline, const PredictiveScore& effect, double excessKurtosis,
                        double noiseChiSquared, double largestZ) {
    constexpr double kAlone = 6.0; // sigma
    return largestZ > kAlone || leavesTooLargeResidual(baseline, effect, excessKurtosis, noiseChiSquared, largestZ);
}

double largestResidualZ(const Localisation& residual) {
    double most = 0.0;
    for (const ResidualWindow& window : residual.significant)
        most = std::max(most, std::abs(window.z));
    return most;
}

PredictiveScore usable(PredictiveScore h, const PredictiveScore& baseline) {
    if (h.failure.empty() && h.energy.allFinite() && h.volume.allFinite())
        return h;
    h.energy = 10.0 * (baseline.energy + baseline.rows);
    h.volume = baseline.volume;
    h.rows = baseline.rows;
    return h;
}

double splitUndetectable(double baseline, const std::vector<std::string>& fitted,
                         std::vector<ScreenedEffect>& screening) {
    double all = kPriorAdequate;
    for (ScreenedEffect& s : screening) {
        const bool apart = std::find(fitted.begin(), fitted.end(), s.label) != fitted.end();
        const double below = s.detectable < 1.0 ? std::max(0.0, s.detectable) : 1.0; // also for NaN
        s.undetectable = apart ? 0.0 : kPriorCatalogue / static_cast<double>(screening.size()) * below;
        all += s.undetectable;
    }
    for (ScreenedEffect& s : screening)
        s.undetectable *= baseline / all;
    return baseline * kPriorAdequate / all;
}

HypothesisPrior priorOf(const std::vector<CandidateEffect>& candidates, const FittedHypothesis& t, std::size_t labels) {
    if (t.learned)
        return {0.5 * kPriorOutsideCatalogue, false};
    const auto isNumber = [](const CandidateEffect& c) { return c.isNumber(); };
    const auto numbers =
        std::count_if(t.candidates.begin(), t.candidates.end(), [&](std::size_t c) { return isNumber(candidates[c]); });
    const bool beside = numbers == static_cast<std::ptrdiff_t>(t.candidates.size());
    double weight = kPriorCatalogue / static_cast<double>(std::max<std::size_t>(1, labels));
    if (t.candidates.size() > 1 && !beside)
        weight *= 0.1;
    if (numbers > 0)
        weight /= static_cast<double>(std::count_if(candidates.begin(), candidates.end(), isNumber));
    return {weight, beside};
}

void removeOutsideCatalogue(ModelWeights& w) {
    const double rest = 1.0 - w.outsideCatalogue;
    w.outsideCatalogue = 0.0;
    w.adequate = rest > 0.0 ? w.adequate / rest : 1.0;
    for (double& p : w.effects)
        p = rest > 0.0 ? p / rest : 0.0;
}

void improvementOf(const PredictiveScore& from, const PredictiveScore& to, std::uint64_t seed, double& share,
                   Interval& ci90) {
    constexpr int kDraws = 1000;
    const auto fall = [](double a, double b) { return a > 0.0 ? 1.0 - std::sqrt(b / a) : 0.0; };
    share = fall(from.energy.sum(), to.energy.sum());
    Random random(seed);
    std::vector<double> draws;
    for (int d = 0; d < kDraws; ++d) {
        double a = 0.0, b = 0.0;
        for (Eigen::Index k = 0; k < from.energy.size(); ++k) {
            const double w = random.exponential();
            a += w * from.energy[k];
            b += w * to.energy[k];
        }
        draws.push_back(fall(a, b));
    }
    std::sort(draws.begin(), draws.end());
    ci90 = {draws[kDraws / 20], draws[kDraws - 1 - kDraws / 20]};
}

Paired paired(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    const Eigen::VectorXd d = a - b;
    const double n = static_cast<double>(std::max<Eigen::Index>(1, d.size()));
    const double variance = n > 1.0 ? (d.array() - d.mean()).square().sum() / (n - 1.0) : 0.0;
    return {d.sum(), std::sqrt(n * variance)};
}

bool alike(const PredictiveScore& a, const PredictiveScore& b, double distance, double dispersion) {
    if (distance / std::sqrt(dispersion) < 3.0)
        return true;
    const Paired p = paired(a.score(dispersion), b.score(dispersion));
    return std::abs(p.difference) < 2.0 * p.error && std::abs(p.difference) < 8.0;
}

double largestLogBayesFactor(double p) {
    constexpr double kE = 2.718281828459045;
    return p > 0.0 && p < 1.0 / kE ? -math::log(-kE * p * math::log(p)) : p <= 0.0 ? 700.0 : 0.0;
}

namespace {

constexpr int kDraws = 2000; // draws of the bootstrap

/// Scores of all hypotheses in every bootstrap draw.
Eigen::MatrixXd drawScores(const std::vector<Eigen::VectorXd>& scores, Random& random, int draws) {
    const Eigen::Index blocks = scores.front().size();
    Eigen::MatrixXd out(draws, static_cast<Eigen::Index>(scores.size()));
    for (int d = 0; d < draws; ++d) {
        Eigen::VectorXd w(blocks);
        for (double& x : w)
            x = random.exponential();
        w *= static_cast<double>(blocks) / w.sum();
        for (std::size_t m = 0; m < scores.size(); ++m)
            out(d, static_cast<Eigen::Index>(m)) = w.dot(scores[m]);
    }
    return out;
}

/// 2.3 % quantile of the difference of two hypotheses. Published gains have this entry, one above lowerQuantile().
double lowEnd(const Eigen::MatrixXd& s, Eigen::Index of, Eigen::Index over) {
    std::vector<double> gains;
    for (Eigen::Index d = 0; d < s.rows(); ++d)
        gains.push_back(s(d, of) - s(d, over));
    std::sort(gains.begin(), gains.end());
    return gains[static_cast<std::size_t>(0.023 * static_cast<double>(gains.size()))];
}

/// "Adequate", "outside the catalogue", then the effects: priors, scores per block and per bootstrap draw.
struct Hypotheses {
    static constexpr std::size_t kEffects = 2; ///< index of the first effect
    static Eigen::Index place(std::size_t effect) { return static_cast<Eigen::Index>(kEffects + effect); }
    [[nodiscard]] double& priorOf(std::size_t effect) { return prior[kEffects + effect]; }

    std::vector<double> prior;
    std::vector<Eigen::VectorXd> scores;
    Eigen::MatrixXd drawn;
};

double leastDispersion(const PredictiveScore& baseline, const std::vector<PredictiveScore>& effects) {
    double least = dispersionOf(baseline);
    for (const PredictiveScore& h : effects)
        least = std::min(least, dispersionOf(h));
    return least;
}

/// Priors and scores; sets the gains over the baseline in `out`.
Hypotheses hypothesesOf(const PredictiveScore& baseline, const std::vector<PredictiveScore>& effects,
                        const WeightingInput& given, ModelWeights& out) {
    const double least = leastDispersion(baseline, effects);
    out.dispersion = std::max(1.0, least);
    Hypotheses all;
    all.scores = {baseline.score(out.dispersion),
                  outsideCatalogueScore(baseline, out.dispersion, std::min(1.0, least), given)};
    all.prior = {kPriorAdequate, kPriorOutsideCatalogue};
    const double catalogue = static_cast<double>(std::max<std::size_t>(1, given.catalogue));
    std::size_t named = 0;
    for (std::size_t i = 0; i < effects.size(); ++i) {
        all.scores.push_back(effects[i].score(out.dispersion));
        all.prior.push_back((i < given.prior.size() ? given.prior[i] : kPriorCatalogue / catalogue) *
                            (given.isAtBound(i) ? kAtBoundPrior : 1.0));
        const bool combined = i < given.mustBeat.size() && !given.mustBeat[i].empty();
        named += combined || given.isOutside(i) || given.isBeside(i) ? 0 : 1;
        const Paired p = paired(all.scores.back(), all.scores.front());
        out.gain.push_back(p.difference);
        out.gainError.push_back(p.error);
    }
    // The prior of effects that were not fitted stays with the baseline.
    all.prior[0] += kPriorCatalogue * std::max(0.0, 1.0 - static_cast<double>(named) / catalogue);
    Random random(given.seed);
    all.drawn = drawScores(all.scores, random, kDraws);
    return all;
}

/// An effect with a gain within chance scores no better than the baseline. A pair no better than one of its components
/// does not count. Sets the best remaining one in `out`.
/// @param room whether an effect allows a second one
template <class Room>
void limitToChance(Hypotheses& all, const WeightingInput& given, const Room& room, ModelWeights& out) {
    const std::size_t effects = out.gain.size();
    for (std::size_t m = 0; m < effects; ++m)
        out.gainLow.push_back(lowEnd(all.drawn, Hypotheses::place(m), 0));
    const Eigen::MatrixXd raw = all.drawn;
    for (std::size_t m = 0; m < effects; ++m) {
        const Eigen::Index at = Hypotheses::place(m);
        if (out.gainLow[m] <= 0.0 && out.gain[m] <= kBeyondChance)
            all.drawn.col(at) = all.drawn.col(at).cwiseMin(raw.col(0));
        for (const std::size_t part : m < given.mustBeat.size() ? given.mustBeat[m] : std::vector<std::size_t>{})
            if (lowEnd(raw, at, Hypotheses::place(part)) <= 0.0 ||
                (out.gain[m] - out.gain[part] < kMaterial * out.gain[part] && (given.isOutside(m) || !room(part))))
                all.priorOf(m) = 0.0;
        if (all.priorOf(m) > 0.0 && (all.priorOf(out.best) <= 0.0 || out.gain[m] > out.gain[out.best]))
            out.best = m;
    }
}

/// "Outside the catalogue" scores at least as the best effect where that is rejected: a residual that neither noise nor
/// another form of the same law leaves, an amplitude at its bound, a forecast that fails, or a periodic disturbance.
/// Over a law that leaves more than noise it gains as much as the significance of what is left allows (decision 0240).
void applyRejection(Hypotheses& all, const PredictiveScore& baseline, const PredictiveScore& best, double floor,
                    const WeightingInput& given, ModelWeights& out) {
    const double left = dispersionOf(best) - floor, toExplain = dispersionOf(baseline) - floor;
    const bool leavesMore = given.residualP <= kFamilyWise && left > kSameLaw * toExplain;
    out.rejected =
        leavesMore || given.isAtBound(out.best) || given.failsToForecast(out.best) || given.periodicDisturbance;
    if (!out.rejected)
        return;
    const double more = leavesMore ? largestLogBayesFactor(given.residualP) : 0.0;
    all.drawn.col(1) = all.drawn.col(1).cwiseMax((all.drawn.col(Hypotheses::place(out.best)).array() + more).matrix());
    const bool refuted = given.failsToForecast(out.best) && dispersionOf(best) - 1.0 > kTrueEffectExcess;
    if (refuted || given.periodicDisturbance) // odds of 150 against the noise being misjudged
        all.drawn.col(1).array() += 5.0;
}

/// @param most largest log Bayes factor that the family-wise p allows
Eigen::VectorXd posterior(const Hypotheses& all, Eigen::Index draw, double most) {
    const auto& s = all.drawn;
    Eigen::VectorXd mass(s.cols());
    const auto counts = [&](Eigen::Index m) { return all.prior[static_cast<std::size_t>(m)] > 0.0; };
    double top = -std::numeric_limits<double>::infinity(); // hypotheses without prior may score higher and overflow
    for (Eigen::Index m = 0; m < mass.size(); ++m)
        top = counts(m) ? std::max(top, s(draw, m)) : top;
    double something = 0.0;
    for (Eigen::Index m = 0; m < mass.size(); ++m) {
        mass[m] = counts(m) ? all.prior[static_cast<std::size_t>(m)] * math::exp(s(draw, m) - top) : 0.0;
        something += m > 0 ? mass[m] : 0.0;
    }
    // Mean evidence of all alternatives, over their whole prior: the family-wise p accounts for the whole search.
    const double factor = math::log(std::max(something / (1.0 - kPriorAdequate), 1e-300)) - (s(draw, 0) - top);
    if (factor > most)
        mass[0] = std::max(mass[0], kPriorAdequate / (1.0 - kPriorAdequate) * something * math::exp(-most));
    return mass / mass.sum();
}

} // namespace

ModelWeights modelWeights(const PredictiveScore& baseline, const std::vector<PredictiveScore>& effects,
                          const WeightingInput& given) {
    ModelWeights out;
    Hypotheses all = hypothesesOf(baseline, effects, given, out);
    const auto room = [&](std::size_t part) {
        return allowsSecondEffect(baseline, effects[part], given.excessKurtosis, given.noiseChiSquared,
                                  given.largestZOf(part));
    };
    limitToChance(all, given, room, out);
    if (!effects.empty())
        applyRejection(all, baseline, effects[out.best], std::min(1.0, leastDispersion(baseline, effects)), given, out);
    const double most = largestLogBayesFactor(given.p);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(all.drawn.cols());
    for (Eigen::Index d = 0; d < all.drawn.rows(); ++d)
        sum += posterior(all, d, most) / kDraws;
    out.adequate = sum[0];
    out.outsideCatalogue = sum[1];
    out.effects.assign(sum.begin() + Hypotheses::kEffects, sum.end());
    return out;
}

} // namespace supercircle::diagnosis
