#include "plugin/identification/diagnosis/selection/weigh.h"

#include "plugin/identification/diagnosis/model/random.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supercircle::diagnosis {

namespace {

/// What an effect that is there leaves of the misfit beyond the noise: two simulators' forms of a law differ by less
/// (0 to 3 % in the training cases); an effect that imitates another leaves more (31 % where relaxation was hidden and
/// softening stood for it).
constexpr double kLeftByTheTrueOne = 0.1;

/// Deviations by which what is left stands out in a window: effects that are there left 4.6, beside another one 7.7.
constexpr double kStandsOut = 8.0;

/// Noise variances beyond the noise itself. Twice its size in all: effects that are there leave up to 1.4 times (the
/// training cases, by a simulator of another kind), one that imitated wear 2.1. Three times: whatever was explained,
/// this was not.
constexpr double kMoreThanTheTrueOne = 3.0, kTooMuch = 8.0;

/// How much rarer an effect is at a size beyond what is plausible: as two causes at once are than one.
constexpr double kStretched = 0.1;

Eigen::VectorXd unknownScore(const HeldOut& nothing, double dispersion, double floor, const Weighing& given) {
    const double rows = std::max(1.0, nothing.rows.sum());
    floor *= noiseBound(rows, given.tails, given.noiseSquares);
    const double toExplain = 0.5 * std::max(0.0, nothing.energy.sum() - floor * rows) / dispersion;
    const double cost = std::max(4.0 * std::log(std::max(2.0, rows)), 0.15 * toExplain);
    // It has the nominal parameters' uncertainty too.
    return -(0.5 * floor / dispersion + cost / rows) * nothing.rows - 0.5 * nothing.volume;
}

} // namespace

double noiseBound(double rows, double tails, double squares) {
    return std::max(1.1, squares) + 2.0 * std::sqrt((2.0 + tails) / std::max(1.0, rows));
}

double dispersionOf(const HeldOut& h) {
    return h.rows.sum() > 0.0 ? h.energy.sum() / h.rows.sum() : 1.0;
}

bool leavesTooMuch(const HeldOut& nothing, const HeldOut& effect, double tails, double noiseSquares, double most) {
    const double excess = dispersionOf(nothing) - 1.0, left = dispersionOf(effect) - 1.0;
    const double bound = noiseBound(nothing.rows.sum(), tails, noiseSquares) - 1.0;
    return (left > bound && left - bound > kLeftByTheTrueOne * (excess - bound)) || left > kMoreThanTheTrueOne ||
           most > kStandsOut;
}

bool leavesRoom(const HeldOut& nothing, const HeldOut& effect, double tails, double noiseSquares, double most) {
    constexpr double kAlone = 6.0; // deviations
    return most > kAlone || leavesTooMuch(nothing, effect, tails, noiseSquares, most);
}

double standsOut(const Localisation& left) {
    double most = 0.0;
    for (const Window& window : left.significant)
        most = std::max(most, std::abs(window.z));
    return most;
}

HeldOut usable(HeldOut h, const HeldOut& nothing) {
    if (h.failure.empty() && h.energy.allFinite() && h.volume.allFinite())
        return h;
    h.energy = 10.0 * (nothing.energy + nothing.rows);
    h.volume = nothing.volume;
    h.rows = nothing.rows;
    return h;
}

double shareUnseen(double nothing, const std::vector<std::string>& fitted, std::vector<SeenEffect>& seen) {
    double all = kNothing;
    for (SeenEffect& s : seen) {
        const bool apart = std::find(fitted.begin(), fitted.end(), s.label) != fitted.end();
        const double below = s.visible < 1.0 ? std::max(0.0, s.visible) : 1.0; // also where it is not a number
        s.unseen = apart ? 0.0 : kCatalogue / static_cast<double>(seen.size()) * below;
        all += s.unseen;
    }
    for (SeenEffect& s : seen)
        s.unseen *= nothing / all;
    return nothing * kNothing / all;
}

void leaveUnknownOut(Weighed& w) {
    const double rest = 1.0 - w.unknown;
    w.unknown = 0.0;
    w.nothing = rest > 0.0 ? w.nothing / rest : 1.0;
    for (double& p : w.effects)
        p = rest > 0.0 ? p / rest : 0.0;
}

void improvementOf(const HeldOut& from, const HeldOut& to, std::uint64_t seed, double& share, Interval& ci90) {
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

bool alike(const HeldOut& a, const HeldOut& b, double distance, double dispersion) {
    if (distance / std::sqrt(dispersion) < 3.0)
        return true;
    const Paired p = paired(a.score(dispersion), b.score(dispersion));
    return std::abs(p.difference) < 2.0 * p.error && std::abs(p.difference) < 8.0;
}

double surprise(double p) {
    constexpr double kE = 2.718281828459045;
    return p > 0.0 && p < 1.0 / kE ? -std::log(-kE * p * std::log(p)) : p <= 0.0 ? 700.0 : 0.0;
}

namespace {

constexpr int kDraws = 2000; // of the bootstrap

/// Scores of all hypotheses in every draw of the bootstrap.
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

/// 2.3 % quantile of the difference of two hypotheses.
double lowEnd(const Eigen::MatrixXd& s, Eigen::Index of, Eigen::Index over) {
    std::vector<double> gains;
    for (Eigen::Index d = 0; d < s.rows(); ++d)
        gains.push_back(s(d, of) - s(d, over));
    std::sort(gains.begin(), gains.end());
    return gains[static_cast<std::size_t>(0.023 * static_cast<double>(gains.size()))];
}

/// "Nothing", "none of these", then the effects: priors, scores per block and in every draw of the bootstrap.
struct Hypotheses {
    static constexpr std::size_t kEffects = 2; ///< place of the first effect
    static Eigen::Index place(std::size_t effect) { return static_cast<Eigen::Index>(kEffects + effect); }
    [[nodiscard]] double& priorOf(std::size_t effect) { return prior[kEffects + effect]; }

    std::vector<double> prior;
    std::vector<Eigen::VectorXd> scores;
    Eigen::MatrixXd drawn;
};

/// Priors and scores, and the gains over "nothing" into `out`.
Hypotheses hypothesesOf(const HeldOut& nothing, const std::vector<HeldOut>& effects, const Weighing& given,
                        Weighed& out) {
    double least = dispersionOf(nothing);
    for (const HeldOut& h : effects)
        least = std::min(least, dispersionOf(h));
    out.dispersion = std::max(1.0, least);
    Hypotheses all;
    all.scores = {nothing.score(out.dispersion), unknownScore(nothing, out.dispersion, std::min(1.0, least), given)};
    all.prior = {kNothing, kUnknown};
    const double catalogue = static_cast<double>(std::max<std::size_t>(1, given.catalogue));
    std::size_t named = 0;
    for (std::size_t i = 0; i < effects.size(); ++i) {
        all.scores.push_back(effects[i].score(out.dispersion));
        all.prior.push_back((i < given.prior.size() ? given.prior[i] : kCatalogue / catalogue) *
                            (given.isPressed(i) ? kStretched : 1.0));
        const bool combined = i < given.parts.size() && !given.parts[i].empty();
        named += combined || given.isOutside(i) ? 0 : 1;
        const Paired p = paired(all.scores.back(), all.scores.front());
        out.gain.push_back(p.difference);
        out.gainError.push_back(p.error);
    }
    // Effects that were not worth a fit do not foretell better than nothing does; their prior stays with it.
    all.prior[0] += kCatalogue * std::max(0.0, 1.0 - static_cast<double>(named) / catalogue);
    Random random(given.seed);
    all.drawn = drawScores(all.scores, random, kDraws);
    return all;
}

/// An effect whose gain is within chance foretells no better than nothing; a pair that says no more than one of its
/// parts does not count. The best of what counts into `out`.
/// @param room whether an effect leaves room for a second one
template <class Room>
void holdToChance(Hypotheses& all, const Weighing& given, const Room& room, Weighed& out) {
    const std::size_t effects = out.gain.size();
    for (std::size_t m = 0; m < effects; ++m)
        out.gainLow.push_back(lowEnd(all.drawn, Hypotheses::place(m), 0));
    const Eigen::MatrixXd raw = all.drawn;
    for (std::size_t m = 0; m < effects; ++m) {
        const Eigen::Index at = Hypotheses::place(m);
        if (out.gainLow[m] <= 0.0 && out.gain[m] <= kBeyondChance)
            all.drawn.col(at) = all.drawn.col(at).cwiseMin(raw.col(0));
        for (const std::size_t part : m < given.parts.size() ? given.parts[m] : std::vector<std::size_t>{})
            if (lowEnd(raw, at, Hypotheses::place(part)) <= 0.0 ||
                (out.gain[m] - out.gain[part] < kMaterial * out.gain[part] && (given.isOutside(m) || !room(part))))
                all.priorOf(m) = 0.0;
        if (all.priorOf(m) > 0.0 && (all.priorOf(out.best) <= 0.0 || out.gain[m] > out.gain[out.best]))
            out.best = m;
    }
}

/// Where the best effect leaves too much, in the mean or in one place, would have to be implausibly large or is beside
/// the point, "none of these" is as good at least.
void refute(Hypotheses& all, const HeldOut& nothing, const HeldOut& best, const Weighing& given, Weighed& out) {
    const double left = dispersionOf(best) - 1.0;
    out.rejected = leavesTooMuch(nothing, best, given.tails, given.noiseSquares, given.leftBy(out.best)) ||
                   given.isPressed(out.best) || given.swings;
    if (out.rejected)
        all.drawn.col(1) = all.drawn.col(1).cwiseMax(all.drawn.col(Hypotheses::place(out.best)));
    if (left > kTooMuch || given.swings) // refuted by the noise: one in 150 that the noise was mistaken instead
        all.drawn.col(1).array() += 5.0;
}

/// Posterior of each hypothesis in one draw.
/// @param most logarithm of the evidence for "something" that the family-wise p allows
Eigen::VectorXd posterior(const Hypotheses& all, Eigen::Index draw, double most) {
    const auto& s = all.drawn;
    Eigen::VectorXd mass(s.cols());
    const auto counts = [&](Eigen::Index m) { return all.prior[static_cast<std::size_t>(m)] > 0.0; };
    double top = -std::numeric_limits<double>::infinity(); // what does not count may score higher, and overflow
    for (Eigen::Index m = 0; m < mass.size(); ++m)
        top = counts(m) ? std::max(top, s(draw, m)) : top;
    double something = 0.0;
    for (Eigen::Index m = 0; m < mass.size(); ++m) {
        mass[m] = counts(m) ? all.prior[static_cast<std::size_t>(m)] * std::exp(s(draw, m) - top) : 0.0;
        something += m > 0 ? mass[m] : 0.0;
    }
    // The mean evidence for "something", which has all of the prior that "nothing" has not: p has paid for the whole
    // search, and what was not worth a fit is not paid for again.
    const double factor = std::log(std::max(something / (1.0 - kNothing), 1e-300)) - (s(draw, 0) - top);
    if (factor > most)
        mass[0] = std::max(mass[0], kNothing / (1.0 - kNothing) * something * std::exp(-most));
    return mass / mass.sum();
}

} // namespace

Weighed weigh(const HeldOut& nothing, const std::vector<HeldOut>& effects, const Weighing& given) {
    Weighed out;
    Hypotheses all = hypothesesOf(nothing, effects, given, out);
    const auto room = [&](std::size_t part) {
        return leavesRoom(nothing, effects[part], given.tails, given.noiseSquares, given.leftBy(part));
    };
    holdToChance(all, given, room, out);
    if (!effects.empty())
        refute(all, nothing, effects[out.best], given, out);
    const double most = surprise(given.p);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(all.drawn.cols());
    for (Eigen::Index d = 0; d < all.drawn.rows(); ++d)
        sum += posterior(all, d, most) / kDraws;
    out.nothing = sum[0];
    out.unknown = sum[1];
    out.effects.assign(sum.begin() + Hypotheses::kEffects, sum.end());
    return out;
}

} // namespace supercircle::diagnosis
