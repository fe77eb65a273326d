#include "plugin/identification/diagnosis/next_experiment.h"
#include "plugin/identification/diagnosis/model/decompositions.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <memory>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Separation of a false hypothesis from the true one.
struct Separation {
    double distance = 0.0;    ///< expected, in sigma of the test statistic under the false hypothesis
    double uncertainty = 0.0; ///< standard deviation of the distance from uncertain parameters of the true hypothesis
    double noise = 1.0;       ///< standard deviation of the statistic around it
    /// Lower bound with probability 0.9.
    [[nodiscard]] double lowerBound() const { return std::max(0.0, distance - 1.28 * uncertainty); }
    /// Power of a one-sided 5 % test, averaged over the uncertain parameters (assurance).
    [[nodiscard]] double power() const {
        return boost::math::cdf(boost::math::normal(),
                                (distance - 1.6448536269514722) / math::hypot(noise, uncertainty));
    }
};

/// A candidate run with its number of repeats.
struct RepeatedRun {
    PredictedRun* run = nullptr;
    std::size_t repeats = 1;
};
using Series = std::vector<RepeatedRun>;

std::size_t countOf(const Series& series) {
    std::size_t n = 0;
    for (const RepeatedRun& p : series)
        n += p.repeats;
    return n;
}

/// Discrimination of hypotheses by a series of runs that are fitted together.
class Discrimination {
public:
    Discrimination(const Evaluator& evaluator, const std::vector<CompetingHypothesis>& competing,
                   const UncertainParameters& uncertain)
        : evaluator_(evaluator), competing_(competing), uncertain_(uncertain) {}

    /// Separation from the alternative hardest to reject, for each hypothesis assumed true, by derivatives. The
    /// baseline is never assumed true.
    [[nodiscard]] std::vector<Separation> separation(const Series& series) const {
        return hardestAlternative(linearisedPairs(series));
    }
    /// The same with refits simulated.
    [[nodiscard]] std::vector<Separation> refined(const Series& series) const {
        std::vector<RefitPair> pairs = linearisedPairs(series);
        refine(series, pairs);
        return hardestAlternative(pairs);
    }
    [[nodiscard]] const std::vector<CompetingHypothesis>& competing() const { return competing_; }

private:
    /// A hypothesis assumed true and another one refitted to its prediction.
    struct RefitPair {
        std::size_t truth = 0, alternative = 0;
        Separation separation;
        dense::Ldlt normal;     ///< factorisation of 1 + J' J, J: effect of one sigma of each parameter
        double remaining = 0.0; ///< remaining chi-squared of the readings
        Eigen::VectorXd at, to; ///< present and next parameters, sigma
        [[nodiscard]] double chiSquared() const { return remaining + at.squaredNorm(); }
    };
    /// Likelihood and derivatives of one part of the series.
    struct PartLikelihood {
        std::unique_ptr<RunLikelihood> likelihood;
        Eigen::MatrixXd derivatives;
    };

    [[nodiscard]] std::vector<RefitPair> linearisedPairs(const Series& series) const {
        std::vector<RefitPair> out;
        for (std::size_t a = 0; a < competing_.size(); ++a) {
            if (competing_[a].point.terms.empty())
                continue;
            Eigen::MatrixXd gram = series.front().run->gram(a, series.front().repeats);
            for (std::size_t s = 1; s < series.size(); ++s)
                gram += series[s].run->gram(a, series[s].repeats);
            for (std::size_t b = 0; b < competing_.size(); ++b)
                if (!contains(a, b))
                    out.push_back(linearised(gram, a, b));
        }
        return out;
    }
    [[nodiscard]] std::vector<Separation> hardestAlternative(const std::vector<RefitPair>& pairs) const {
        std::vector<Separation> out(competing_.size());
        std::vector<bool> any(competing_.size(), false);
        for (const RefitPair& p : pairs)
            if (!any[p.truth] || p.separation.lowerBound() < out[p.truth].lowerBound()) {
                out[p.truth] = p.separation;
                any[p.truth] = true;
            }
        return out;
    }
    /// Whether b contains all effects of a: then it cannot be rejected if a is true.
    [[nodiscard]] bool contains(std::size_t a, std::size_t b) const {
        if (competing_[a].mirrorImage != competing_[b].mirrorImage)
            return false;
        const std::vector<Term>&of = competing_[a].point.terms, &by = competing_[b].point.terms;
        return std::all_of(of.begin(), of.end(), [&](const Term& t) {
            return std::any_of(by.begin(), by.end(), [&](const Term& u) { return u.candidate == t.candidate; });
        });
    }
    /// Linearised separation.
    [[nodiscard]] RefitPair linearised(const Eigen::MatrixXd& gram, std::size_t truth, std::size_t alternative) const {
        const Eigen::MatrixXd& d = uncertain_.factorByItem(alternative);
        const Index n = uncertain_.size(), from = n + static_cast<Index>(alternative);
        const Eigen::VectorXd by = d.transpose() * gram.col(from).head(n); // J' left
        const Eigen::MatrixXd square = d.transpose() * gram.topLeftCorner(n, n) * d;
        RefitPair p;
        p.truth = truth;
        p.alternative = alternative;
        p.remaining = gram(from, from);
        p.normal.compute(Eigen::MatrixXd::Identity(d.cols(), d.cols()) + square);
        p.at = Eigen::VectorXd::Zero(d.cols());
        p.to = p.normal.solve(by);
        const double chiSquared = p.remaining - by.dot(p.to); // left' (1 + J J')^-1 left
        if (!std::isfinite(chiSquared) || chiSquared <= 0.0)
            return p;
        // Remaining residual, rest = left - J to, projected on the uncertain parameters of both hypotheses.
        const Eigen::VectorXd rest = gram.col(from).head(n) - gram.topLeftCorner(n, n) * (d * p.to);
        const double distance = std::sqrt(chiSquared);
        p.separation = {distance, (uncertain_.factorByItem(truth).transpose() * rest).norm() / distance,
                        std::sqrt(std::max(0.0, 1.0 - (d.transpose() * rest).squaredNorm() / chiSquared))};
        return p;
    }
    /// Simulated refits with constant derivatives (chord method), all pairs together; the smaller distance counts.
    void refine(const Series& series, std::vector<RefitPair>& pairs) const {
        constexpr int kMost = 5;
        constexpr double kLittle = 0.98; // ratio of chi-squared: smaller gains are not worth a simulation
        std::vector<RefitPair*> active;
        for (RefitPair& p : pairs)
            if (p.separation.lowerBound() > 0.0)
                active.push_back(&p);
        std::vector<std::vector<PartLikelihood>> own(competing_.size()); // by the hypothesis assumed true
        for (const RefitPair* p : active)
            for (std::size_t s = own[p->truth].size(); s < series.size(); ++s) {
                own[p->truth].push_back({series[s].run->likelihoodOf(p->truth, series[s].repeats), {}});
                own[p->truth].back().derivatives =
                    series[s].run->derivatives(*own[p->truth].back().likelihood, series[s].repeats);
            }
        for (int i = 0; i < kMost && !active.empty() && !evaluator_.stopped(); ++i) {
            std::vector<ParameterPoint> points;
            for (RefitPair* p : active)
                points.push_back(bounded(*p));
            std::vector<std::vector<CandidateRunResponse>> responses; // [part][pair]
            for (const RepeatedRun& repeatFactor : series)
                responses.push_back(repeatFactor.run->at(points));
            std::vector<RefitPair*> next;
            for (std::size_t k = 0; k < active.size(); ++k) {
                RefitPair& p = *active[k];
                const Eigen::MatrixXd& d = uncertain_.factorByItem(p.alternative);
                double remaining = 0.0;
                Eigen::VectorXd by = Eigen::VectorXd::Zero(d.cols());
                for (std::size_t s = 0; s < series.size(); ++s) {
                    const PartLikelihood& its = own[p.truth][s];
                    const Eigen::VectorXd difference =
                        series[s].run->difference(*its.likelihood, series[s].repeats, p.truth, responses[s][k]);
                    remaining += difference.size() > 0 ? difference.squaredNorm()
                                                       : 2.0 * p.chiSquared(); // a failed simulation is rejected
                    if (difference.size() > 0 && its.derivatives.rows() == difference.size())
                        by += d.transpose() * (its.derivatives.transpose() * difference);
                }
                const double before = p.chiSquared(), now = remaining + p.to.squaredNorm();
                if (!(now < before)) {
                    p.to = 0.5 * (p.to + p.at);
                    next.push_back(&p);
                    continue;
                }
                p.at = p.to;
                p.remaining = remaining;
                p.to = p.at + p.normal.solve(by - p.at);
                if (now < kLittle * before)
                    next.push_back(&p);
            }
            active = std::move(next);
        }
        for (RefitPair& p : pairs)
            if (p.separation.lowerBound() > 0.0)
                p.separation.distance = std::min(p.separation.distance, std::sqrt(p.chiSquared()));
    }
    /// Next parameters of a pair, inside their bounds; `to` is set to them.
    [[nodiscard]] ParameterPoint bounded(RefitPair& p) const {
        const CompetingHypothesis& alternative = competing_[p.alternative];
        const Variables v(evaluator_.model(), alternative.point);
        const Eigen::MatrixXd& factor = uncertain_.factor(p.alternative);
        const Eigen::VectorXd wanted = alternative.x + factor * p.to, x = wanted.cwiseMax(v.lower).cwiseMin(v.upper);
        if (x != wanted)
            p.to = dense::leastSquares(factor, x - alternative.x);
        return v.at(x);
    }

    const Evaluator& evaluator_;
    const std::vector<CompetingHypothesis>& competing_;
    const UncertainParameters& uncertain_;
};

constexpr std::size_t kMostRepeats = 8; ///< of all runs together
constexpr double kRequiredShare = 0.98; ///< weight of the hypotheses that must be separated
/// Required separation, sigma: a gain of 12.5. A gain of 8 held by the two strokes of one run leaves a probability of
/// 0.88, this one 0.95 (decision 0088).
constexpr double kRequiredSeparation = 5.0;

/// A proposed series of runs with its expected discrimination.
struct Proposal {
    Series series;
    double score = 0.0;     ///< 1: whichever hypothesis is true, all others are rejected
    double power = 0.0;     ///< mean over the hypotheses
    double potential = 0.0; ///< discrimination of the largest allowed number of runs
    [[nodiscard]] bool suffices() const { return score >= kRequiredShare; }
    [[nodiscard]] std::size_t count() const { return series.empty() ? kMostRepeats : countOf(series); }
    /// Fewer runs if both suffice; otherwise more discrimination.
    [[nodiscard]] bool better(const Proposal& other) const {
        return suffices() && other.suffices() ? count() < other.count() : potential > other.potential;
    }
};

Proposal proposalOf(const Discrimination& discrimination, const Series& series, bool refined = false) {
    const std::vector<Separation> separation =
        refined ? discrimination.refined(series) : discrimination.separation(series);
    const std::vector<CompetingHypothesis>& competing = discrimination.competing();
    Proposal out{series};
    double weights = 0.0;
    for (std::size_t i = 0; i < competing.size(); ++i)
        if (!competing[i].point.terms.empty()) {
            weights += competing[i].weight;
            out.score += competing[i].weight * std::min(1.0, separation[i].lowerBound() / kRequiredSeparation);
            out.power += competing[i].weight * separation[i].power();
        }
    if (weights > 0.0) {
        out.score /= weights;
        out.power /= weights;
    }
    out.potential = out.score;
    return out;
}

/// `count` runs in the proportions of a series, each kind at least once.
Series inProportion(const Series& as, std::size_t count) {
    Series out = as;
    std::size_t remaining = count, of = countOf(as);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t behind = out.size() - 1 - i; // kinds that need one run each
        const std::size_t fair = (remaining * as[i].repeats + of / 2) / of;
        out[i].repeats = behind == 0 ? remaining : std::clamp<std::size_t>(fair, 1, remaining - behind);
        remaining -= out[i].repeats;
        of -= as[i].repeats;
    }
    return out;
}

/// Smallest number of runs in [least, most] that suffices; if none does, the smallest that discriminates nearly as much
/// as the largest.
template <class Of>
Proposal smallestSufficient(const Of& of, std::size_t least, std::size_t most) {
    constexpr double kNearly = 0.9;
    const Proposal largest = of(most);
    Proposal out = largest;
    for (std::size_t n = least; n < most; ++n)
        if (const Proposal proposal = of(n);
            proposal.suffices() || (!largest.suffices() && proposal.score >= kNearly * largest.score)) {
            out = proposal;
            break;
        }
    out.potential = std::max(largest.score, out.score); // sufficient proposals come first (better())
    return out;
}

/// A linearised proposal with simulated refits, extended to as many repeats as needed.
Proposal refinedProposal(const Discrimination& discrimination, const Proposal& linear, std::size_t most) {
    const auto refined = [&](std::size_t count) {
        return proposalOf(discrimination, inProportion(linear.series, count), true);
    };
    Proposal out = refined(linear.count());
    if (!linear.suffices() && linear.score > 0.0)
        out.potential = linear.potential * out.score / linear.score; // of the largest allowed number
    if (!linear.suffices() || out.suffices() || out.count() == most)
        return out;
    std::size_t few = out.count();
    out = refined(most);
    while (out.suffices() && out.count() > few + 1) { // fewer may suffice
        const Proposal less = refined((few + out.count()) / 2);
        if (less.suffices())
            out = less;
        else
            few = less.count();
    }
    return out;
}

constexpr double kLittle = 0.25; ///< of the required discrimination: less is not worth a run

/// The best single kind of run with repeats.
/// @param runs on return those that can be simulated
Proposal bestOfOne(const Evaluator& evaluator, const Discrimination& discrimination,
                   std::vector<std::unique_ptr<PredictedRun>>& runs) {
    Proposal best;
    std::vector<std::unique_ptr<PredictedRun>> usable;
    for (std::size_t i = 0; i < runs.size() && !evaluator.stopped(); ++i) {
        if (best.suffices() && best.count() == 1)
            break; // the first one in the list is the simplest
        PredictedRun* run = runs[i].get();
        const std::size_t most = best.suffices() ? best.count() - 1 : kMostRepeats;
        if (!run->simulate())
            continue;
        usable.push_back(std::move(runs[i]));
        if (proposalOf(discrimination, {{run, most}}).score <
            std::max(kLittle, std::min(kRequiredShare, best.potential)))
            continue;
        run->differentiate();
        const Proposal linear = smallestSufficient(
            [&](std::size_t n) {
                evaluator.stop().poll();
                return proposalOf(discrimination, {{run, n}});
            },
            1, most);
        if (!linear.better(best))
            continue;
        if (const Proposal proposal = refinedProposal(discrimination, linear, most); proposal.better(best))
            best = proposal;
    }
    runs = std::move(usable);
    return best;
}

/// The best two kinds of runs, if one kind needs many repeats or does not suffice.
/// @param alone the best single kind
Proposal bestOfTwo(const Evaluator& evaluator, const Discrimination& discrimination,
                   const std::vector<std::unique_ptr<PredictedRun>>& runs, const Proposal& alone) {
    constexpr std::size_t kSaved = 2; // saved runs that justify a second kind
    constexpr double kMore = 1.1;     // gain in discrimination that justifies a second kind
    constexpr int kTries = 3;         // number of linearised proposals that are refined
    Proposal best = alone;
    if (alone.suffices() && alone.count() <= kSaved + 1)
        return best;
    for (const auto& run : runs)
        if (!evaluator.stopped())
            run->differentiate();
    const std::size_t most = alone.suffices() ? alone.count() - kSaved : kMostRepeats;
    std::vector<Proposal> proposals;
    for (std::size_t i = 0; i < runs.size(); ++i)
        for (std::size_t j = i + 1; j < runs.size() && !evaluator.stopped(); ++j)
            proposals.push_back(smallestSufficient(
                [&](std::size_t count) {
                    Proposal out;
                    evaluator.stop().poll();
                    for (std::size_t n = 1; n < count; ++n)
                        if (Proposal o = proposalOf(discrimination, {{runs[i].get(), n}, {runs[j].get(), count - n}});
                            out.series.empty() || o.score > out.score)
                            out = std::move(o);
                    return out;
                },
                2, most));
    std::stable_sort(proposals.begin(), proposals.end(),
                     [](const Proposal& a, const Proposal& b) { return a.better(b); });
    const auto worthwhile = [&](const Proposal& o) { return o.suffices() || o.potential > kMore * alone.potential; };
    for (int i = 0; i < kTries && i < static_cast<int>(proposals.size()) && !evaluator.stopped(); ++i) {
        if (!worthwhile(proposals[i]) || !proposals[i].better(best))
            break;
        if (const Proposal proposal = refinedProposal(discrimination, proposals[i], most);
            worthwhile(proposal) && proposal.better(best))
            best = proposal;
    }
    return best;
}

} // namespace

std::optional<NextExperiment> nextExperiment(Evaluator& evaluator, const std::vector<CompetingHypothesis>& competing,
                                             const Noise& noise, double zeroWindow) {
    if (noise.total() <= 0.0 || competing.size() < 2)
        return std::nullopt;
    const std::vector<CandidateRun> candidateRuns = evaluator.model().candidateRuns();
    const UncertainParameters uncertain(evaluator.model(), competing);
    const Discrimination discrimination(evaluator, competing, uncertain);
    std::vector<std::unique_ptr<PredictedRun>> runs;
    for (std::size_t i = 0; i < candidateRuns.size(); ++i)
        runs.push_back(
            std::make_unique<PredictedRun>(evaluator, i, candidateRuns[i], noise, zeroWindow, competing, uncertain));
    Proposal best = bestOfOne(evaluator, discrimination, runs);
    if (!evaluator.stopped())
        best = bestOfTwo(evaluator, discrimination, runs, best);
    if (best.score < kLittle || evaluator.stopped())
        return std::nullopt;
    NextExperiment out;
    for (const RepeatedRun& repeatFactor : best.series)
        out.runs.push_back({repeatFactor.run->candidateRun(), repeatFactor.repeats});
    for (const CompetingHypothesis& r : competing)
        if (r.mirrorImage)
            out.resolvesSign = true;
        else
            out.discriminates.push_back(r.label);
    out.power = best.power;
    out.expectedConclusive = best.suffices();
    return out;
}

std::string noRunDiscriminates(const Diagnosis& d) {
    return "None of the " + std::to_string(d.candidateRunsConsidered) +
           " candidate runs, alone or in pairs with up to " + std::to_string(kMostRepeats) +
           " repeats, would discriminate the hypotheses. Reduce the noise of the readings, or state parameters with "
           "smaller uncertainties.";
}

std::string describeRuns(const std::vector<FurtherRun>& runs) {
    std::string text;
    for (const FurtherRun& run : runs)
        text += (text.empty() ? "" : ", and ") + run.candidateRun.description +
                (run.repeats > 1 ? ", made " + std::to_string(run.repeats) + " times" : "");
    return text;
}

std::string describeNext(const NextExperiment& next) {
    const std::string they =
        next.runs.size() > 1 ? "the best of the candidates, but they" : "the best of the candidates, but it";
    return describeRuns(next.runs) + (next.expectedConclusive ? "" : " (" + they + " may be inconclusive)");
}

} // namespace supercircle::diagnosis
