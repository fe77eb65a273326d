#include "plugin/diagnosis/next.h"

#include "plugin/diagnosis/sight.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <cstdint>
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

/// How far a rival may go to foretell what another one does.
enum class Refit : std::uint8_t {
    None,    ///< it stays, which refutes more than there is
    Linear,  ///< by derivatives
    Searched ///< by derivatives, and simulated where these take it
};

/// A run that was not made, as rivals foretell it.
class Foretold {
public:
    Foretold(Evaluator& evaluator, std::size_t index, const Design& design, const Noise& noise, double zeroWindow,
             const std::vector<Rival>& rivals)
        : evaluator_(evaluator), index_(index), design_(design), noise_(noise), zeroWindow_(zeroWindow),
          rivals_(rivals) {}

    /// False if it cannot be simulated.
    bool simulate() {
        std::vector<Point> points;
        for (const Rival& r : rivals_)
            points.push_back(r.point);
        responses_ = evaluator_.foretell(index_, points);
        return responses_.front().force.size() >= 8 &&
               std::all_of(responses_.begin(), responses_.end(), [&](const DesignResponse& r) { return usable(r); });
    }
    /// What refitting may take up, and what is not known of the predictions: derivatives by the nominal parameters,
    /// which do much the same in all rivals, and by each rival's own numbers.
    void differentiate() {
        std::vector<Point> points;
        own_.clear();
        moved_.clear();
        for (std::size_t i = 0; i < rivals_.size(); ++i) {
            const Rival& r = rivals_[i];
            const Variables v(evaluator_.model(), r.point);
            nominal_ = v.nominal;
            own_.push_back(static_cast<Index>(points.size()));
            for (Index k = i == 0 ? 0 : v.nominal; k < v.size(); ++k) {
                Eigen::VectorXd y = r.x;
                const double step = r.x[k] + kStep <= v.upper[k] ? kStep : -kStep; // to the side that has room
                y[k] += step;
                points.push_back(v.at(y));
                moved_.push_back({i, k, step, {}});
            }
        }
        own_.front() = nominal_;
        auto there = evaluator_.foretell(index_, points);
        for (std::size_t k = 0; k < there.size(); ++k) { // what fails may be simulated to the other side
            Moved& m = moved_[k];
            const Rival& r = rivals_[m.rival];
            const Variables v(evaluator_.model(), r.point);
            Eigen::VectorXd y = r.x;
            y[m.number] -= m.step;
            if (!usable(there[k]) && y[m.number] >= v.lower[m.number] && y[m.number] <= v.upper[m.number]) {
                m.step = -m.step;
                there[k] = evaluator_.foretell(index_, {v.at(y)}).front();
            }
            m.response = std::move(there[k]);
        }
    }
    /// How well so many of these runs, fitted together, refute whichever other rival is hardest to refute if one is
    /// true; of rivals without effects nothing, for that is not asked.
    [[nodiscard]] std::vector<Told> told(std::size_t repeats, Refit refit) const {
        std::vector<std::unique_ptr<Sight>> sights;
        std::vector<Pair> pairs;
        for (std::size_t a = 0; a < rivals_.size(); ++a) {
            if (rivals_[a].point.terms.empty())
                continue;
            sights.push_back(std::make_unique<Sight>(design_, responses_[a], noise_, zeroWindow_, repeats));
            const Eigen::MatrixXd changes =
                refit == Refit::None ? Eigen::MatrixXd() : changesIn(*sights.back(), repeats);
            for (std::size_t b = 0; b < rivals_.size(); ++b)
                if (!within(a, b))
                    pairs.push_back(refuted(*sights.back(), changes, a, b, repeats));
        }
        if (refit == Refit::Searched)
            search(pairs, repeats);
        std::vector<Told> out(rivals_.size());
        std::vector<bool> any(rivals_.size(), false);
        for (const Pair& p : pairs)
            if (!any[p.is] || p.told.surely() < out[p.is].surely()) {
                out[p.is] = p.told;
                any[p.is] = true;
            }
        return out;
    }

private:
    static constexpr double kStep = 0.2; ///< of x

    /// The run with one number of a rival changed.
    struct Moved {
        std::size_t rival = 0;
        Index number = 0;
        double step = 0.0;
        DesignResponse response;
    };
    /// One rival that is true and one that is refitted to what it foretells.
    struct Pair {
        std::size_t is = 0, said = 0;
        const Sight* sight = nullptr; ///< of the one that is true
        Told told;
        Eigen::MatrixXd by;                  ///< what one deviation of each of its numbers changes
        Eigen::LDLT<Eigen::MatrixXd> normal; ///< of 1 + by' by
        Eigen::VectorXd left;                ///< where it stands: the readings that are left, all repeats together
        Eigen::VectorXd at, to;              ///< where that is, and where derivatives lead from there, deviations
        [[nodiscard]] double squares() const { return left.squaredNorm() + at.squaredNorm(); }
    };

    [[nodiscard]] bool usable(const DesignResponse& r) const {
        return r.failure.empty() && r.force.size() == responses_.front().force.size() &&
               r.markers.size() == responses_.front().markers.size();
    }
    /// Of all repeats together, by each of moved_, in noise units; zero where it cannot be simulated.
    [[nodiscard]] Eigen::MatrixXd changesIn(const Sight& sight, std::size_t repeats) const {
        Eigen::MatrixXd out;
        for (std::size_t k = 0; k < moved_.size(); ++k) {
            const Moved& m = moved_[k];
            const DesignResponse& from = responses_[m.rival];
            const auto change = sight.apart(usable(m.response) ? m.response : from, from);
            if (!change)
                continue;
            if (out.size() == 0)
                out.setZero(change->size(), static_cast<Index>(moved_.size()));
            out.col(static_cast<Index>(k)) = std::sqrt(static_cast<double>(repeats)) / m.step * *change;
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
    /// How a rival's numbers deviate: a column each of what one deviation changes in x.
    [[nodiscard]] Eigen::MatrixXd factorOf(std::size_t rival) const {
        const Eigen::LLT<Eigen::MatrixXd> llt(rivals_[rival].covariance);
        return llt.info() == Eigen::Success
                   ? Eigen::MatrixXd(llt.matrixL())
                   : Eigen::MatrixXd(rivals_[rival].covariance.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal());
    }
    /// What one deviation each of a rival's numbers changes in the readings, of columns by moved_.
    [[nodiscard]] Eigen::MatrixXd deviations(const Eigen::MatrixXd& changes, std::size_t rival) const {
        const Eigen::MatrixXd factor = factorOf(rival);
        return changes.leftCols(nominal_) * factor.topRows(nominal_) +
               changes.middleCols(own_[rival], factor.rows() - nominal_) * factor.bottomRows(factor.rows() - nominal_);
    }
    /// By derivatives. @param changes empty: nothing is refitted
    [[nodiscard]] Pair refuted(const Sight& sight, const Eigen::MatrixXd& changes, std::size_t is, std::size_t said,
                               std::size_t repeats) const {
        Pair p;
        p.is = is;
        p.said = said;
        p.sight = &sight;
        const auto seen = sight.apart(responses_[is], responses_[said]);
        if (!seen)
            return p;
        p.left = std::sqrt(static_cast<double>(repeats)) * *seen;
        p.told = {p.left.norm()};
        if (changes.size() == 0)
            return p;
        p.by = deviations(changes, said);
        p.normal.compute(Eigen::MatrixXd::Identity(p.by.cols(), p.by.cols()) + p.by.transpose() * p.by);
        p.at = Eigen::VectorXd::Zero(p.by.cols());
        p.to = p.normal.solve(p.by.transpose() * p.left);
        const Eigen::VectorXd rest = p.left - p.by * p.to; // (1 + by by')^-1 of it
        const double square = p.left.dot(rest);
        p.told = {};
        if (!std::isfinite(square) || square <= 0.0)
            return p;
        const double distance = std::sqrt(square);
        p.told = {distance, (deviations(changes, is).transpose() * rest).norm() / distance,
                  std::sqrt(std::max(0.0, 1.0 - (p.by.transpose() * rest).squaredNorm() / square))};
        return p;
    }
    /// How near a rival comes by simulations from where the derivatives lead, which are kept (chord method), where that
    /// is nearer than these say. All pairs go on together.
    void search(std::vector<Pair>& pairs, std::size_t repeats) const {
        constexpr int kMost = 5;
        constexpr double kLittle = 0.98; // of the squares: what is gained beyond is not worth a simulation
        const double root = std::sqrt(static_cast<double>(repeats));
        std::vector<Pair*> walking;
        for (Pair& p : pairs)
            if (p.told.surely() > 0.0)
                walking.push_back(&p);
        for (int i = 0; i < kMost && !walking.empty() && !evaluator_.stopped(); ++i) {
            std::vector<Point> points;
            for (Pair* p : walking)
                points.push_back(bounded(*p));
            const auto there = evaluator_.foretell(index_, points);
            std::vector<Pair*> on;
            for (std::size_t k = 0; k < walking.size(); ++k) {
                Pair& p = *walking[k];
                const auto left = usable(there[k]) ? p.sight->apart(responses_[p.is], there[k]) : std::nullopt;
                const double before = p.squares(),
                             now = left ? static_cast<double>(repeats) * left->squaredNorm() + p.to.squaredNorm()
                                        : 2.0 * before;
                if (!(now < before)) {
                    p.to = 0.5 * (p.to + p.at);
                    on.push_back(&p);
                    continue;
                }
                p.at = p.to;
                p.left = root * *left;
                p.to = p.at + p.normal.solve(p.by.transpose() * p.left - p.at);
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
        const Eigen::MatrixXd factor = factorOf(p.said);
        const Eigen::VectorXd wanted = said.x + factor * p.to, x = wanted.cwiseMax(v.lower).cwiseMin(v.upper);
        if (x != wanted)
            p.to = factor.completeOrthogonalDecomposition().solve(x - said.x);
        return v.at(x);
    }

    Evaluator& evaluator_;
    std::size_t index_;
    Design design_;
    const Noise& noise_;
    double zeroWindow_;
    const std::vector<Rival>& rivals_;
    std::vector<DesignResponse> responses_; ///< of the rivals
    std::vector<Moved> moved_;              ///< by the nominal parameters (of the first), by each rival's own numbers
    Index nominal_ = 0;                     ///< number of nominal parameters
    std::vector<Index> own_;                ///< first of moved_ by a rival's own numbers
};

constexpr std::size_t kMostRepeats = 8;
constexpr double kAll = 0.98;   ///< of the suspects, by weight, that are told well enough
constexpr double kEnough = 4.0; ///< units beyond which runs are all as good: a gain of 8 on the runs

/// A design, made so many times.
struct Offer {
    std::size_t repeats = kMostRepeats;
    double worth = 0.0;   ///< 1: whichever rival is true, all others are refuted
    double power = 0.0;   ///< mean over the rivals
    double promise = 0.0; ///< worth of as many runs as may be made
    [[nodiscard]] bool enough() const { return worth >= kAll; }
    /// What takes fewer runs, or where none tells enough what tells more.
    [[nodiscard]] bool better(const Offer& other) const {
        return enough() && other.enough() ? repeats < other.repeats : promise > other.promise;
    }
};

Offer offerOf(const Foretold& run, const std::vector<Rival>& rivals, std::size_t repeats, Refit refit) {
    const std::vector<Told> told = run.told(repeats, refit);
    Offer out{repeats};
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
    return out;
}

/// As few runs as tell enough; where even the most do not, as few as tell nearly as much.
Offer bestOffer(const Foretold& run, const std::vector<Rival>& rivals, std::size_t most) {
    constexpr double kNearly = 0.9;
    const Offer farthest = offerOf(run, rivals, most, Refit::Linear);
    Offer out = farthest;
    for (std::size_t n = 1; n < most; ++n)
        if (const Offer offer = offerOf(run, rivals, n, Refit::Linear);
            offer.enough() || (!farthest.enough() && offer.worth >= kNearly * farthest.worth)) {
            out = offer;
            break;
        }
    out.promise = farthest.worth;
    return out;
}

/// An offer by derivatives, looked at where these lead, and as much more often as that takes.
Offer checked(const Foretold& run, const std::vector<Rival>& rivals, const Offer& linear, std::size_t most) {
    const auto searched = [&](std::size_t repeats) {
        Offer offer = offerOf(run, rivals, repeats, Refit::Searched);
        offer.promise = offer.worth;
        return offer;
    };
    Offer out = searched(linear.repeats);
    if (!linear.enough() && linear.worth > 0.0)
        out.promise = linear.promise * out.worth / linear.worth; // of as many as may be
    if (!linear.enough() || out.enough() || out.repeats == most)
        return out;
    std::size_t few = out.repeats;
    out = searched(most);
    while (out.enough() && out.repeats > few + 1) { // fewer may do
        const Offer less = searched((few + out.repeats) / 2);
        if (less.enough())
            out = less;
        else
            few = less.repeats;
    }
    return out;
}

} // namespace

std::optional<NextExperiment> nextExperiment(Evaluator& evaluator, const std::vector<Rival>& rivals, const Noise& noise,
                                             double zeroWindow) {
    if (noise.total() <= 0.0 || rivals.size() < 2)
        return std::nullopt;
    constexpr double kLittle = 0.25; // of what is enough: less is not worth a run
    Offer best;
    NextExperiment out;
    const std::vector<Design> designs = evaluator.model().designs();
    for (std::size_t i = 0; i < designs.size() && !evaluator.stopped(); ++i) {
        if (best.enough() && best.repeats == 1)
            break; // the first one listed is the simplest
        Foretold run(evaluator, i, designs[i], noise, zeroWindow, rivals);
        const std::size_t most = best.enough() ? best.repeats - 1 : kMostRepeats;
        if (!run.simulate() ||
            offerOf(run, rivals, most, Refit::None).worth < std::max(kLittle, std::min(kAll, best.promise)))
            continue;
        run.differentiate();
        const Offer linear = bestOffer(run, rivals, most);
        if (!linear.better(best))
            continue;
        if (const Offer offer = checked(run, rivals, linear, most); offer.better(best)) {
            best = offer;
            out.run = designs[i];
        }
    }
    if (best.worth < kLittle || evaluator.stopped())
        return std::nullopt;
    out.repeats = best.repeats;
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
    return "None of the " + std::to_string(d.nextTried) + " further runs that were looked at, made up to " +
           std::to_string(kMostRepeats) +
           " times, would tell: it takes a reading with less noise, or stated numbers that are better known.";
}

std::string inWords(const NextExperiment& next) {
    return next.run.what + (next.repeats > 1 ? ", made " + std::to_string(next.repeats) + " times" : "") +
           (next.settles ? "" : " (of the runs that were looked at it tells most, but it may not settle the matter)");
}

} // namespace supercircle::diagnosis
