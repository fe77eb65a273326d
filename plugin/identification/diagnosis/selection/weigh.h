#pragma once
// From held-out scores to probabilities, groups and a verdict.
//
// Probability: pseudo-BMA with the Bayesian bootstrap over blocks. Weights w ~ Dirichlet(1, ..., 1) over the blocks
// give scores S_m = B sum_b w_b l_mb; P_m is the mean over draws of prior_m exp S_m / sum. Prior masses: 0.3 that
// nothing is missing, 0.1 for something that is not in the catalogue, the rest in equal parts.
//
// "None of these" scores as a model would that leaves pure noise (of a size known to some 5 %), minus what a flexible
// law of eight numbers costs, (8/2) log n, or 15 % of what there is to explain if that is more: a named law that
// explains more than 85 % of the misfit is believed, because no two simulators agree better.
//
// Nothing takes mass from "nothing" without evidence that holds for the whole search: an effect counts no better than
// "nothing" unless its gain on unseen rows is beyond two standard errors or more than chance gives (six; an effect that
// shows in few blocks has a large standard error because it is there: weak ones had gains of 9 to 14 with errors of 6
// to 11, and "nothing" .9), and all hypotheses together gain at most the
// Bayes factor that the family-wise p-value allows, 1 / (-e p ln p) for p < 1/e, else 1 (T. Sellke, M. J. Bayarri, J.
// O. Berger, Am. Stat. 55 (2001) 62), over the odds of 7 to 3 that something is missing: p has paid for the whole
// search, and effects that were not worth a fit, whose prior counts as "nothing"'s among the scores, are not paid for
// again (a weak effect of p = .02 had "nothing" at .6 beside one hypothesis worth a fit and .4 beside six). Without the
// first rule a control's best rival, fitted to two simulators' common differences, reached .85 beside a verdict of
// nothing missing.
//
// A best model that is itself rejected on unseen rows (it leaves more than noise could, noiseBound(), and a tenth of
// what there was to explain beyond that; or four noise variances, whatever there was) cannot beat "none of these": a
// linear drag on a real pendulum explained nine tenths of 98 degrees and left 22, with a noise of .06; softening that
// imitated relaxation left 31 %, effects that were there 0 to 3 %.
//
// Nor can one whose size lies at the end of what is plausible and is pressed beyond it (pressedAmplitudes()), which has
// a tenth of its prior besides: a strip damaged at one place, without damage in the catalogue, was "gravity" of (-15,
// -25) m/s^2 with a tilt, to 1.03 of the noise and with a probability of 1.
//
// Nor can one that leaves something in one place, however little that is in the mean: where what it leaves stands out
// of the noise by more than eight deviations of a window's statistic, twice what is significant. A soft machine that
// was in no catalogue was "local damage" and "plasticity" with .9 and left a peak of twelve noise units at each
// reversal, 16 % of a noise variance per row. In that blind set (seed 2039) effects out of the catalogue left 7.2 to 37
// deviations to whatever was put first, effects that were there 4.4 at most (4.6 in the training cases), and 7.6 a play
// of which plasticity beside it was not found.
//
// Scores are tempered by the dispersion of the best model, c = max(1, chi^2 per row): what even the best model leaves
// makes all of them less sure (quasi-likelihood).
//
// Sources: Y. Yao, A. Vehtari, D. Simpson, A. Gelman, Bayesian Anal. 13 (2018) 917 (pseudo-BMA+); D. B. Rubin, Ann.
// Stat. 9 (1981) 130 (Bayesian bootstrap); K. P. Burnham, D. R. Anderson, "Model Selection", 2nd ed. (2002), 2.5
// (dispersion).

#include "plugin/identification/diagnosis/localisation/localise.h"
#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/heldout.h"

#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Prior probability that nothing is missing, that what is missing is in no catalogue; the catalogue shares the rest.
constexpr double kNothing = 0.3, kUnknown = 0.1, kCatalogue = 1.0 - kNothing - kUnknown;

/// Two simulators' common differences are worth this share of what an effect explains: a second effect or a learned law
/// that adds less is not believed, unless the first leaves room for one (leavesRoom()). Of a machine that
/// gives way under a strip that relaxes the machine was 97 % of the squares, and the 3 % it left were seven noise
/// variances a row: the second effect was not even looked for, and the case "unexplained".
constexpr double kMaterial = 0.03;

/// A gain that chance does not give. Without an effect the gain of a forecast that lies delta away (noise units) is
/// z delta - delta^2 / 2 with z a normal deviate, at most z^2 / 2: six needs z = 3.5, once in 4000, or in a hundred
/// searches of forty hypotheses.
constexpr double kBeyondChance = 6.0;

struct Weighed {
    /// 2.3 % quantile of the gain over the bootstrap's draws: two standard errors below it where gains are normal.
    /// Where a few blocks hold most of the gain, a standard error would count their size against it.
    std::vector<double> gainLow;
    double nothing = 0.0, unknown = 0.0;
    std::vector<double> effects;         ///< probabilities, as the input
    std::vector<double> gain, gainError; ///< of the score over "nothing", and its standard error over blocks
    double dispersion = 1.0;
    /// The best model leaves too much on unseen rows or in one place, is pressed beyond what is plausible, or rests
    /// swing.
    bool rejected = false;
    std::size_t best = 0; ///< the highest score of those without `parts` or beyond them; meaningless without effects
    /// Whether `a` is the one of two effects to show.
    [[nodiscard]] bool better(std::size_t a, std::size_t b) const {
        return effects[a] != effects[b] ? effects[a] > effects[b] : gain[a] > gain[b];
    }
};

struct Weighing {
    std::size_t catalogue = 1; ///< number of labels there are, also those that were not fitted
    double p = 0.0;            ///< family-wise, of the nominal fit
    double tails = 0.0;        ///< excess kurtosis of the noise
    double noiseSquares = 1.0; ///< squares per row that noise may have if it is larger than thought (mostSquares())
    std::vector<double> prior; ///< of each effect; empty: shares of kCatalogue
    /// Of each effect: those it must beat by two standard errors to count at all (the parts of a pair, the best named
    /// effect for a learned law).
    std::vector<std::vector<std::size_t>> parts;
    std::vector<char> outside; ///< of each effect, whether it is in no catalogue (a learned law); empty: none is
    [[nodiscard]] bool isOutside(std::size_t effect) const { return effect < outside.size() && outside[effect] != 0; }
    /// Of each effect, whether a size lies at the end of what is plausible and is pressed beyond it; empty: none.
    std::vector<char> pressed;
    [[nodiscard]] bool isPressed(std::size_t effect) const { return effect < pressed.size() && pressed[effect] != 0; }
    /// Most of what "nothing" leaves of the force is a swing that goes on while the head stands still: no specimen
    /// and no effect of the catalogue makes that, however well one may follow a part of it.
    bool swings = false;
    /// How far what each effect leaves stands out, deviations of the largest significant window (standsOut()); empty,
    /// 0: nothing does, or it was not looked at.
    std::vector<double> left;
    [[nodiscard]] double leftBy(std::size_t effect) const { return effect < left.size() ? left[effect] : 0.0; }
    std::uint64_t seed = 1;
};
/// All of them usable(), as many blocks as `nothing`.
Weighed weigh(const HeldOut& nothing, const std::vector<HeldOut>& effects, const Weighing& given);

/// A model whose fit or forecast broke down in some fold foretells nothing: it scores far below no effect at all.
HeldOut usable(HeldOut held, const HeldOut& nothing);

/// Whether an effect that is fitted leaves more on unseen rows than noise and another simulator's ways could, in the
/// mean or in one place.
/// @param standsOut of what it leaves
bool leavesTooMuch(const HeldOut& nothing, const HeldOut& effect, double tails, double noiseSquares, double standsOut);

/// Whether a second effect may be as small as it likes beside one: that leaves too much, or a window of more than six
/// deviations. Effects that are there alone left 4.6 at most, those with a second one beside them 7.4 and 7.7.
/// @param standsOut of what it leaves
bool leavesRoom(const HeldOut& nothing, const HeldOut& effect, double tails, double noiseSquares, double standsOut);

/// Deviations of the largest significant window; 0 if there is none.
double standsOut(const Localisation& left);

/// Shares what "nothing" has with effects that may be there and are too small for these runs: into `seen[k].unseen`,
/// and returns what is left. Weighed::nothing is all that foretells no better than nothing does, and an effect loses
/// by not being seen only the sizes at which it would have been: each that was not fitted keeps the share of its prior
/// that lies below the smallest visible size, sizes up to one that matters being equally likely. Undivided "nothing"
/// had .99 wherever nothing stood out, and in seven of twenty-two such cases of seeds 2040 and 2041 a weak effect was
/// hidden.
/// @param fitted labels that have a probability of their own
double shareUnseen(double nothing, const std::vector<std::string>& fitted, std::vector<SeenEffect>& seen);

/// Shares the mass of "none of these" among the others (an ablation).
void leaveUnknownOut(Weighed& weighed);

/// Logarithm of the largest Bayes factor against "nothing" that a p-value allows, >= 0.
double surprise(double p);

/// Standardised squared error per row that noise alone may leave: an energy of `rows` give or take sqrt(2 rows), more
/// with heavy tails (excess kurtosis), of a noise whose size is known to 5 % at best.
/// @param squares per row that noise may have if it is larger than thought (mostSquares())
double noiseBound(double rows, double tails, double squares);

/// Standardised squared error per row on unseen rows.
double dispersionOf(const HeldOut& held);

/// By which share the error on unseen rows falls, with 90 % of the bootstrap over blocks.
void improvementOf(const HeldOut& from, const HeldOut& to, std::uint64_t seed, double& share, Interval& ci90);

/// Whether two models cannot be told apart: their predictions lie within three noise units, or their scores within two
/// standard errors of the paired difference.
bool alike(const HeldOut& a, const HeldOut& b, double distance, double dispersion);

/// Mean and standard error of the sum of paired differences a - b over blocks.
struct Paired {
    double difference = 0.0, error = 0.0;
};
Paired paired(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

} // namespace supercircle::diagnosis
