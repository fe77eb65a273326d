#pragma once
// Model weights from predictive scores: pseudo-BMA with the Bayesian bootstrap over blocks. Weights w ~ Dirichlet(1,
// ..., 1) give scores S_m = B sum_b w_b l_mb; P_m is the mean over draws of prior_m exp S_m / sum. Priors: 0.3
// adequate, 0.1 outside the catalogue, the rest in equal parts.
//
// Bounds: gains within chance do not count, and all hypotheses together gain at most the Bayes factor 1 / (-e p ln p)
// that the family-wise p allows (T. Sellke, M. J. Bayarri, J. O. Berger, Am. Stat. 55 (2001) 62; decision 0080).
// "Outside the catalogue" scores as a flexible law of eight parameters, and at least as a rejected best effect
// (decisions 0081, 0240). Scores are tempered by the dispersion of the best model.
// Sources: Y. Yao, A. Vehtari, D. Simpson, A. Gelman, Bayesian Anal. 13 (2018) 917; D. B. Rubin, Ann. Stat. 9 (1981)
// 130; K. P. Burnham, D. R. Anderson, "Model Selection", 2nd ed. (2002), 2.5 (dispersion).

#include "plugin/identification/diagnosis/localisation/localise.h"
#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/cross_validation.h"
#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"

#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Prior probabilities: adequate, outside the catalogue, and all catalogue effects together.
constexpr double kPriorAdequate = 0.3, kPriorOutsideCatalogue = 0.1,
                 kPriorCatalogue = 1.0 - kPriorAdequate - kPriorOutsideCatalogue;

/// Smallest relative gain of a second effect or learned law, because simulators differ that much. Not required if the
/// first effect allows a second one (allowsSecondEffect()).
constexpr double kMaterial = 0.03;

/// A gain that chance does not give. The gain of a forecast at distance delta (sigma) is z delta - delta^2 / 2 with a
/// normal z, at most z^2 / 2. Six needs z = 3.5, once in a hundred searches of forty hypotheses.
constexpr double kBeyondChance = 6.0;

struct ModelWeights {
    /// 2.3 % bootstrap quantile of the gain. For skewed gains it is better than two standard errors.
    std::vector<double> gainLow;
    double adequate = 0.0, outsideCatalogue = 0.0;
    std::vector<double> effects;         ///< probabilities, as the input
    std::vector<double> gain, gainError; ///< of the score over the baseline, and its standard error over blocks
    double dispersion = 1.0;
    /// The best hypothesis is rejected: a significant residual, an amplitude at its bound, a forecast that fails, or a
    /// periodic disturbance.
    bool rejected = false;
    std::size_t best = 0; ///< highest score among those that beat their `mustBeat`; meaningless without effects
    /// Whether effect `a` ranks before `b`.
    [[nodiscard]] bool better(std::size_t a, std::size_t b) const {
        return effects[a] != effects[b] ? effects[a] > effects[b] : gain[a] > gain[b];
    }
};

struct WeightingInput {
    std::size_t catalogue = 1;    ///< number of labels, fitted or not
    double p = 0.0;               ///< family-wise, of the baseline
    double excessKurtosis = 0.0;  ///< of the noise
    double noiseChiSquared = 1.0; ///< upper bound of the noise per row (noiseChiSquaredBound())
    std::vector<double> prior;    ///< of each effect; empty: equal shares of kPriorCatalogue
    /// For each effect, those it must beat by two standard errors (components of a pair, the best effect for a learned
    /// law).
    std::vector<std::vector<std::size_t>> mustBeat;
    std::vector<char> outside; ///< for each effect, whether it is outside the catalogue (a learned law); empty: none
    [[nodiscard]] bool isOutside(std::size_t effect) const { return effect < outside.size() && outside[effect] != 0; }
    /// For each effect, whether it is beside the catalogue (a stated number that is wrong); empty: none.
    std::vector<char> beside;
    [[nodiscard]] bool isBeside(std::size_t effect) const { return effect < beside.size() && beside[effect] != 0; }
    /// For each effect, whether an amplitude is at the end of its plausible range; empty: none.
    std::vector<char> atBound;
    [[nodiscard]] bool isAtBound(std::size_t effect) const { return effect < atBound.size() && atBound[effect] != 0; }
    /// For each effect, whether its forecast of a free run fails (forecastsOf()); empty: none.
    std::vector<char> forecastFails;
    [[nodiscard]] bool failsToForecast(std::size_t effect) const {
        return effect < forecastFails.size() && forecastFails[effect] != 0;
    }
    /// Whether a periodic disturbance, which no specimen causes, dominates the baseline residual.
    bool periodicDisturbance = false;
    /// Largest significant window statistic of each effect's residual, sigma (largestResidualZ()); empty or 0: none, or
    /// not computed.
    std::vector<double> largestZ;
    [[nodiscard]] double largestZOf(std::size_t effect) const {
        return effect < largestZ.size() ? largestZ[effect] : 0.0;
    }
    double residualP = 1.0; ///< family-wise, of the residual of the best effect (Localisation::extendedP); 1: unknown
    std::uint64_t seed = 1;
};
struct HypothesisPrior {
    double weight = 0.0;
    bool beside = false; ///< as WeightingInput::beside
};
/// Two simultaneous effects have a tenth of the prior of one; a learned law has half of that of "outside the
/// catalogue". All stated numbers together have the prior of one effect; two of them are no rarer than one, as another
/// specimen differs in all (decision 0231).
/// @param labels of the catalogue
HypothesisPrior priorOf(const std::vector<CandidateEffect>& candidates, const FittedHypothesis& hypothesis,
                        std::size_t labels);

/// All scores must be usableScore() with as many blocks as the baseline.
ModelWeights modelWeights(const PredictiveScore& baseline, const std::vector<PredictiveScore>& effects,
                          const WeightingInput& given);

/// Replaces the score of a failed fit or forecast by one far below the baseline.
PredictiveScore usable(PredictiveScore held, const PredictiveScore& baseline);

/// Whether a fitted effect leaves more held-out residual than noise and simulator differences allow, in the mean or in
/// one window: its fit is worth repeating, and a second effect may act.
/// @param largestZ largest window statistic of its residual, sigma
bool leavesTooLargeResidual(const PredictiveScore& baseline, const PredictiveScore& effect, double excessKurtosis,
                            double noiseChiSquared, double largestZ);

/// Whether a second effect may have a small gain: the residual is too large, or a window exceeds six sigma (decision
/// 0081).
/// @param largestZ largest window statistic of the residual, sigma
bool allowsSecondEffect(const PredictiveScore& baseline, const PredictiveScore& effect, double excessKurtosis,
                        double noiseChiSquared, double largestZ);

/// Statistic of the largest significant window, sigma; 0 if there is none.
double largestResidualZ(const Localisation& residual);

/// Splits the probability of the baseline into "adequate" and effects too small to be detected, and returns the former.
/// Each effect that was not fitted keeps its prior below the detectable amplitude, amplitudes up to a relevant one
/// being equally likely (decision 0080).
/// @param fitted labels with a probability of their own
double splitUndetectable(double baseline, const std::vector<std::string>& fitted,
                         std::vector<ScreenedEffect>& screening);

/// Removes the hypothesis "outside the catalogue" and renormalises (ablation).
void removeOutsideCatalogue(ModelWeights& weights);

/// Logarithm of the largest Bayes factor against the baseline that a p-value allows, >= 0.
double largestLogBayesFactor(double p);

/// Mean squared standardised error that noise alone may leave, for noise known to 5 % at best.
/// @param noiseChiSquared upper bound of the noise per row (noiseChiSquaredBound())
double noiseBound(double rows, double excessKurtosis, double squares);

/// Mean squared standardised error of held-out rows.
double dispersionOf(const PredictiveScore& held);

/// Relative decrease of the held-out error, with the 90 % bootstrap interval over blocks.
void improvementOf(const PredictiveScore& from, const PredictiveScore& to, std::uint64_t seed, double& share,
                   Interval& ci90);

/// Whether two hypotheses are indistinguishable: predictions within three sigma, or scores within two standard errors
/// of the paired difference (decision 0083).
bool alike(const PredictiveScore& a, const PredictiveScore& b, double distance, double dispersion);

/// Mean and standard error of the sum of paired differences a - b over blocks.
struct Paired {
    double difference = 0.0, error = 0.0;
};
Paired paired(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

} // namespace supercircle::diagnosis
