#include "plugin/identification/diagnosis/next.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <memory>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// How well runs refute a rival that is not true.
struct Told {
    double distance = 0.0; ///< expected, in deviations of the test's statistic if that rival were true
    double open = 0.0;     ///< deviation of it, because what is true is known from a fit only
    double noise = 1.0;    ///< deviation of the statistic around it
    /// What it is with a probability of .9.
    [[nodiscard]] double surely() const { return std::max(0.0, distance - 1.28 * open); }
    /// Of a one-sided test at 5 %, over what is open (its assurance).
    [[nodiscard]] double power() const {
        return boost::math::cdf(boost::math::normal(), (distance - 1.6448536269514722) / std::hypot(noise, open));
    }
};

/// A run, made so many times.
struct Part {
    Foretold* run = nullptr;
    std::size_t repeats = 1;
};
using Series = std::vector<Part>;

std::size_t countOf(const Series& series) {
    std::size_t n = 0;
    for (const Part& p : series)
        n += p.repeats;
    return n;
}

/// What a series of runs, fitted together, tells of rivals.
class Contest {
public:
    Contest(const Evaluator& evaluator, const std::vector<Rival>& rivals, const Open& open)
        : evaluator_(evaluator), rivals_(rivals), open_(open) {}

    /// How well they refute whichever other rival is hardest to refute if one is true; of rivals without effects
    /// nothing, for that is not asked. By derivatives, as far as there are any.
    [[nodiscard]] std::vector<Told> told(const Series& series) const { return hardest(pairsOf(series)); }
    /// The same, simulated where derivatives lead.
    [[nodiscard]] std::vector<Told> searched(const Series& series) const {
        std::vector<Pair> pairs = pairsOf(series);
        search(series, pairs);
        return hardest(pairs);
    }
    [[nodiscard]] const std::vector<Rival>& rivals() const { return rivals_; }

private:
    /// One rival that is true and one that is refitted to what it foretells.
    struct Pair {
        std::size_t is = 0, said = 0;
        Told told;
        Eigen::LDLT<Eigen::MatrixXd> normal; ///< of 1 + J' J, J: what one deviation of each of its numbers changes
        double left = 0.0;                   ///< squares of the readings that are left where it stands
        Eigen::VectorXd at, to;              ///< where that is, and where derivatives lead from there, deviations
        [[nodiscard]] double squares() const { return left + at.squaredNorm(); }
    };
    /// A part of the series where one rival is true.
    struct Seen {
        std::unique_ptr<Sight> sight;
        Eigen::MatrixXd changes;
    };

    [[nodiscard]] std::vector<Pair> pairsOf(const Series& series) const {
        std::vector<Pair> out;
        for (std::size_t a = 0; a < rivals_.size(); ++a) {
            if (rivals_[a].point.terms.empty())
                continue;
            Eigen::MatrixXd products = series.front().run->products(a, series.front().repeats);
            for (std::size_t s = 1; s < series.size(); ++s)
                products += series[s].run->products(a, series[s].repeats);
            for (std::size_t b = 0; b < rivals_.size(); ++b)
                if (!within(a, b))
                    out.push_back(refuted(products, a, b));
        }
        return out;
    }
    [[nodiscard]] std::vector<Told> hardest(const std::vector<Pair>& pairs) const {
        std::vector<Told> out(rivals_.size());
        std::vector<bool> any(rivals_.size(), false);
        for (const Pair& p : pairs)
            if (!any[p.is] || p.told.surely() < out[p.is].surely()) {
                out[p.is] = p.told;
                any[p.is] = true;
            }
        return out;
    }
    /// Whether b can do all that a does: it cannot be refuted where a is true.
    [[nodiscard]] bool within(std::size_t a, std::size_t b) const {
        if (rivals_[a].otherSide != rivals_[b].otherSide)
            return false;
        const std::vector<Term>&of = rivals_[a].point.terms, &by = rivals_[b].point.terms;
        return std::all_of(of.begin(), of.end(), [&](const Term& t) {
            return std::any_of(by.begin(), by.end(), [&](const Term& u) { return u.candidate == t.candidate; });
        });
    }
    /// By derivatives.
    [[nodiscard]] Pair refuted(const Eigen::MatrixXd& products, std::size_t is, std::size_t said) const {
        const Eigen::MatrixXd& d = open_.deviations(said);
        const Index n = open_.size(), from = n + static_cast<Index>(said);
        const Eigen::VectorXd by = d.transpose() * products.col(from).head(n); // J' left
        const Eigen::MatrixXd square = d.transpose() * products.topLeftCorner(n, n) * d;
        Pair p;
        p.is = is;
        p.said = said;
        p.left = products(from, from);
        p.normal.compute(Eigen::MatrixXd::Identity(d.cols(), d.cols()) + square);
        p.at = Eigen::VectorXd::Zero(d.cols());
        p.to = p.normal.solve(by);
        const double squares = p.left - by.dot(p.to); // left' (1 + J J')^-1 left
        if (!std::isfinite(squares) || squares <= 0.0)
            return p;
        // What stays of the readings, rest = left - J to, by what is open in the one that is true and in the other.
        const Eigen::VectorXd rest = products.col(from).head(n) - products.topLeftCorner(n, n) * (d * p.to);
        const double distance = std::sqrt(squares);
        p.told = {distance, (open_.deviations(is).transpose() * rest).norm() / distance,
                  std::sqrt(std::max(0.0, 1.0 - (d.transpose() * rest).squaredNorm() / squares))};
        return p;
    }
    /// How near a rival comes by simulations from where the derivatives lead, which are kept (chord method), where that
    /// is nearer than these say. All pairs go on together.
    void search(const Series& series, std::vector<Pair>& pairs) const {
        constexpr int kMost = 5;
        constexpr double kLittle = 0.98; // of the squares: what is gained beyond is not worth a simulation
        std::vector<Pair*> walking;
        for (Pair& p : pairs)
            if (p.told.surely() > 0.0)
                walking.push_back(&p);
        std::vector<std::vector<Seen>> seen(rivals_.size()); // by which is true
        for (const Pair* p : walking)
            for (std::size_t s = seen[p->is].size(); s < series.size(); ++s) {
                seen[p->is].push_back({series[s].run->sightOf(p->is, series[s].repeats), {}});
                seen[p->is].back().changes = series[s].run->changes(*seen[p->is].back().sight, series[s].repeats);
            }
        for (int i = 0; i < kMost && !walking.empty() && !evaluator_.stopped(); ++i) {
            std::vector<Point> points;
            for (Pair* p : walking)
                points.push_back(bounded(*p));
            std::vector<std::vector<DesignResponse>> there; // [part][pair]
            for (const Part& part : series)
                there.push_back(part.run->at(points));
            std::vector<Pair*> on;
            for (std::size_t k = 0; k < walking.size(); ++k) {
                Pair& p = *walking[k];
                const Eigen::MatrixXd& d = open_.deviations(p.said);
                double left = 0.0;
                Eigen::VectorXd by = Eigen::VectorXd::Zero(d.cols());
                for (std::size_t s = 0; s < series.size(); ++s) {
                    const Seen& its = seen[p.is][s];
                    const Eigen::VectorXd apart =
                        series[s].run->apart(*its.sight, series[s].repeats, p.is, there[s][k]);
                    left += apart.size() > 0 ? apart.squaredNorm() : 2.0 * p.squares(); // what fails is no way
                    if (apart.size() > 0 && its.changes.rows() == apart.size())
                        by += d.transpose() * (its.changes.transpose() * apart);
                }
                const double before = p.squares(), now = left + p.to.squaredNorm();
                if (!(now < before)) {
                    p.to = 0.5 * (p.to + p.at);
                    on.push_back(&p);
                    continue;
                }
                p.at = p.to;
                p.left = left;
                p.to = p.at + p.normal.solve(by - p.at);
                if (now < kLittle * before)
                    on.push_back(&p);
            }
            walking = std::move(on);
        }
        for (Pair& p : pairs)
            if (p.told.surely() > 0.0)
                p.told.distance = std::min(p.told.distance, std::sqrt(p.squares()));
    }
    /// Where a pair goes next, inside what is possible; `to` becomes that.
    [[nodiscard]] Point bounded(Pair& p) const {
        const Rival& said = rivals_[p.said];
        const Variables v(evaluator_.model(), said.point);
        const Eigen::MatrixXd& factor = open_.factor(p.said);
        const Eigen::VectorXd wanted = said.x + factor * p.to, x = wanted.cwiseMax(v.lower).cwiseMin(v.upper);
        if (x != wanted)
            p.to = factor.completeOrthogonalDecomposition().solve(x - said.x);
        return v.at(x);
    }

    const Evaluator& evaluator_;
    const std::vector<Rival>& rivals_;
    const Open& open_;
};

constexpr std::size_t kMostRepeats = 8; ///< of all runs together
constexpr double kAll = 0.98;           ///< of the suspects, by weight, that are told well enough
/// Units beyond which runs are all as good: a gain of 12.5 on the runs. Named is what has .9, the mean over what
/// strokes may weigh (weigh.h): of a gain of 8 that the two strokes of one run hold .88 is left, of this one .95. With
/// four units two of six cases of seed 2048 that were to be settled ended at .86 and .89.
constexpr double kEnough = 5.0;

/// A series of runs, and what is expected of it.
struct Offer {
    Series series;
    double worth = 0.0;   ///< 1: whichever rival is true, all others are refuted
    double power = 0.0;   ///< mean over the rivals
    double promise = 0.0; ///< worth of as many runs as may be made
    [[nodiscard]] bool enough() const { return worth >= kAll; }
    [[nodiscard]] std::size_t count() const { return series.empty() ? kMostRepeats : countOf(series); }
    /// What takes fewer runs, or where none tells enough what tells more.
    [[nodiscard]] bool better(const Offer& other) const {
        return enough() && other.enough() ? count() < other.count() : promise > other.promise;
    }
};

Offer offerOf(const Contest& contest, const Series& series, bool searched = false) {
    const std::vector<Told> told = searched ? contest.searched(series) : contest.told(series);
    const std::vector<Rival>& rivals = contest.rivals();
    Offer out{series};
    double weights = 0.0;
    for (std::size_t i = 0; i < rivals.size(); ++i)
        if (!rivals[i].point.terms.empty()) {
            weights += rivals[i].weight;
            out.worth += rivals[i].weight * std::min(1.0, told[i].surely() / kEnough);
            out.power += rivals[i].weight * told[i].power();
        }
    if (weights > 0.0) {
        out.worth /= weights;
        out.power /= weights;
    }
    out.promise = out.worth;
    return out;
}

/// So many runs, divided as the series is, each at least once.
Series divided(const Series& as, std::size_t count) {
    Series out = as;
    std::size_t left = count, of = countOf(as);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t behind = out.size() - 1 - i; // that want one each
        const std::size_t fair = (left * as[i].repeats + of / 2) / of;
        out[i].repeats = behind == 0 ? left : std::clamp<std::size_t>(fair, 1, left - behind);
        left -= out[i].repeats;
        of -= as[i].repeats;
    }
    return out;
}

/// Of what is offered for `least` to `most` runs the fewest that tell enough; where even the most do not, the fewest
/// that tell nearly as much.
template <class Of>
Offer fewest(const Of& of, std::size_t least, std::size_t most) {
    constexpr double kNearly = 0.9;
    const Offer farthest = of(most);
    Offer out = farthest;
    for (std::size_t n = least; n < most; ++n)
        if (const Offer offer = of(n);
            offer.enough() || (!farthest.enough() && offer.worth >= kNearly * farthest.worth)) {
            out = offer;
            break;
        }
    out.promise = std::max(farthest.worth, out.worth); // what is enough is before all that is not (better())
    return out;
}

/// An offer by derivatives, looked at where these lead, and as much more often as that takes.
Offer checked(const Contest& contest, const Offer& linear, std::size_t most) {
    const auto searched = [&](std::size_t count) { return offerOf(contest, divided(linear.series, count), true); };
    Offer out = searched(linear.count());
    if (!linear.enough() && linear.worth > 0.0)
        out.promise = linear.promise * out.worth / linear.worth; // of as many as may be
    if (!linear.enough() || out.enough() || out.count() == most)
        return out;
    std::size_t few = out.count();
    out = searched(most);
    while (out.enough() && out.count() > few + 1) { // fewer may do
        const Offer less = searched((few + out.count()) / 2);
        if (less.enough())
            out = less;
        else
            few = less.count();
    }
    return out;
}

constexpr double kLittle = 0.25; ///< of what is enough: less is not worth a run

/// The best of one run and its repeats. @param runs becomes those that can be simulated
Offer bestOfOne(const Evaluator& evaluator, const Contest& contest, std::vector<std::unique_ptr<Foretold>>& runs) {
    Offer best;
    std::vector<std::unique_ptr<Foretold>> usable;
    for (std::size_t i = 0; i < runs.size() && !evaluator.stopped(); ++i) {
        if (best.enough() && best.count() == 1)
            break; // the first one listed is the simplest
        Foretold* run = runs[i].get();
        const std::size_t most = best.enough() ? best.count() - 1 : kMostRepeats;
        if (!run->simulate())
            continue;
        usable.push_back(std::move(runs[i]));
        if (offerOf(contest, {{run, most}}).worth < std::max(kLittle, std::min(kAll, best.promise)))
            continue;
        run->differentiate();
        const Offer linear = fewest([&](std::size_t n) { return offerOf(contest, {{run, n}}); }, 1, most);
        if (!linear.better(best))
            continue;
        if (const Offer offer = checked(contest, linear, most); offer.better(best))
            best = offer;
    }
    runs = std::move(usable);
    return best;
}

/// Two different runs, where one takes many repeats or does not tell enough: what one leaves open the other may know.
/// @param alone the best of one
Offer bestOfTwo(const Evaluator& evaluator, const Contest& contest, const std::vector<std::unique_ptr<Foretold>>& runs,
                const Offer& alone) {
    constexpr std::size_t kSaved = 2; // runs, by which a second kind of run is worth its trouble
    constexpr double kMore = 1.1;     // times as much told, likewise
    constexpr int kTries = 3;         // what derivatives promise is looked at
    Offer best = alone;
    if (alone.enough() && alone.count() <= kSaved + 1)
        return best;
    for (const auto& run : runs)
        if (!evaluator.stopped())
            run->differentiate();
    const std::size_t most = alone.enough() ? alone.count() - kSaved : kMostRepeats;
    std::vector<Offer> offers;
    for (std::size_t i = 0; i < runs.size(); ++i)
        for (std::size_t j = i + 1; j < runs.size() && !evaluator.stopped(); ++j)
            offers.push_back(fewest(
                [&](std::size_t count) {
                    Offer out;
                    for (std::size_t n = 1; n < count; ++n)
                        if (Offer o = offerOf(contest, {{runs[i].get(), n}, {runs[j].get(), count - n}});
                            out.series.empty() || o.worth > out.worth)
                            out = std::move(o);
                    return out;
                },
                2, most));
    std::stable_sort(offers.begin(), offers.end(), [](const Offer& a, const Offer& b) { return a.better(b); });
    const auto worthIt = [&](const Offer& o) { return o.enough() || o.promise > kMore * alone.promise; };
    for (int i = 0; i < kTries && i < static_cast<int>(offers.size()) && !evaluator.stopped(); ++i) {
        if (!worthIt(offers[i]) || !offers[i].better(best))
            break;
        if (const Offer offer = checked(contest, offers[i], most); worthIt(offer) && offer.better(best))
            best = offer;
    }
    return best;
}

} // namespace

std::optional<NextExperiment> nextExperiment(Evaluator& evaluator, const std::vector<Rival>& rivals, const Noise& noise,
                                             double zeroWindow) {
    if (noise.total() <= 0.0 || rivals.size() < 2)
        return std::nullopt;
    const std::vector<Design> designs = evaluator.model().designs();
    const Open open(evaluator.model(), rivals);
    const Contest contest(evaluator, rivals, open);
    std::vector<std::unique_ptr<Foretold>> runs;
    for (std::size_t i = 0; i < designs.size(); ++i)
        runs.push_back(std::make_unique<Foretold>(evaluator, i, designs[i], noise, zeroWindow, rivals, open));
    Offer best = bestOfOne(evaluator, contest, runs);
    if (!evaluator.stopped())
        best = bestOfTwo(evaluator, contest, runs, best);
    if (best.worth < kLittle || evaluator.stopped())
        return std::nullopt;
    NextExperiment out;
    for (const Part& part : best.series)
        out.runs.push_back({part.run->design(), part.repeats});
    for (const Rival& r : rivals)
        if (r.otherSide)
            out.side = true;
        else
            out.separates.push_back(r.label);
    out.power = best.power;
    out.settles = best.enough();
    return out;
}

std::string noneTells(const Diagnosis& d) {
    return "None of the " + std::to_string(d.nextTried) +
           " further runs that were looked at, nor any two of them, made up to " + std::to_string(kMostRepeats) +
           " times in all, would tell: it takes a reading with less noise, or stated numbers that are better known.";
}

std::string listed(const std::vector<FurtherRun>& runs) {
    std::string text;
    for (const FurtherRun& run : runs)
        text += (text.empty() ? "" : ", and ") + run.design.what +
                (run.repeats > 1 ? ", made " + std::to_string(run.repeats) + " times" : "");
    return text;
}

std::string inWords(const NextExperiment& next) {
    const std::string they = next.runs.size() > 1 ? "they tell most, but they" : "it tells most, but it";
    return listed(next.runs) +
           (next.settles ? "" : " (of the runs that were looked at " + they + " may not settle the matter)");
}

} // namespace supercircle::diagnosis
