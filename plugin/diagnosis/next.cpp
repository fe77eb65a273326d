#include "plugin/diagnosis/next.h"

#include "plugin/diagnosis/sight.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

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

/// A run that was not made, as rivals foretell it.
class Foretold {
public:
    Foretold(Evaluator& evaluator, std::size_t index, const Design& design, const Noise& noise,
             const std::vector<Rival>& rivals)
        : evaluator_(evaluator), index_(index), design_(design), noise_(noise), rivals_(rivals) {}

    /// False if it cannot be simulated.
    bool simulate() {
        std::vector<Point> points;
        for (const Rival& r : rivals_)
            points.push_back(r.point);
        responses_ = evaluator_.foretell(index_, points);
        if (responses_.front().force.size() < 8)
            return false;
        for (const DesignResponse& r : responses_)
            if (!usable(r))
                return false;
        columns_.resize(readingsOf(responses_.front()).size(), static_cast<Index>(rivals_.size()));
        for (std::size_t i = 0; i < rivals_.size(); ++i)
            columns_.col(static_cast<Index>(i)) = readingsOf(responses_[i]);
        return true;
    }
    /// What refitting may take up, and what is not known of the predictions: derivatives by the nominal parameters,
    /// which do much the same in all rivals, and by each rival's own numbers.
    void differentiate() {
        std::vector<Point> points;
        std::vector<double> steps;
        std::vector<std::size_t> from;
        std::vector<Index> number;
        own_.clear();
        nominal_ = 0;
        for (std::size_t i = 0; i < rivals_.size(); ++i) {
            const Rival& r = rivals_[i];
            const Variables v(evaluator_.model(), r.point);
            nominal_ = v.nominal;
            own_.push_back(static_cast<Index>(points.size()) + (i == 0 ? v.nominal : 0));
            for (Index k = i == 0 ? 0 : v.nominal; k < v.size(); ++k) {
                Eigen::VectorXd y = r.x;
                steps.push_back(r.x[k] + kStep <= v.upper[k] ? kStep : -kStep); // to the side that has room
                y[k] += steps.back();
                points.push_back(v.at(y));
                from.push_back(i);
                number.push_back(k);
            }
        }
        auto there = evaluator_.foretell(index_, points);
        for (std::size_t k = 0; k < there.size(); ++k) { // what fails may be simulated to the other side
            const Rival& r = rivals_[from[k]];
            const Variables v(evaluator_.model(), r.point);
            Eigen::VectorXd y = r.x;
            y[number[k]] -= steps[k];
            if (usable(there[k]) || y[number[k]] < v.lower[number[k]] || y[number[k]] > v.upper[number[k]])
                continue;
            steps[k] = -steps[k];
            there[k] = evaluator_.foretell(index_, {v.at(y)}).front();
        }
        const auto n = static_cast<Index>(rivals_.size());
        columns_.conservativeResize(Eigen::NoChange, n + static_cast<Index>(there.size()));
        for (std::size_t k = 0; k < there.size(); ++k) { // zero where neither can be simulated
            const Index at = n + static_cast<Index>(k);
            columns_.col(at).setZero();
            if (!usable(there[k]))
                continue;
            const Eigen::VectorXd change = (readingsOf(there[k]) - readingsOf(responses_[from[k]])) / steps[k];
            if (change.allFinite())
                columns_.col(at) = change;
        }
    }
    /// How well so many of these runs, fitted together, refute whichever other rival is hardest to refute if one is
    /// true. @param refit false: none is refitted, which is more than there is
    [[nodiscard]] std::vector<Told> told(std::size_t repeats, bool refit) const {
        const Eigen::MatrixXd sums = seenProducts(design_, responses_.front(), noise_, columns_, repeats);
        std::vector<Told> out;
        for (std::size_t a = 0; a < rivals_.size(); ++a) {
            std::optional<Told> hardest;
            for (std::size_t b = 0; b < rivals_.size(); ++b)
                if (!within(a, b))
                    if (const Told t = refuted(sums, a, b, refit); !hardest || t.surely() < hardest->surely())
                        hardest = t;
            out.push_back(hardest.value_or(Told{}));
        }
        return out;
    }

private:
    static constexpr double kStep = 0.2; ///< of x

    [[nodiscard]] bool usable(const DesignResponse& r) const {
        return r.failure.empty() && r.force.size() == responses_.front().force.size() &&
               r.markers.size() == responses_.front().markers.size();
    }
    [[nodiscard]] static Eigen::VectorXd readingsOf(const DesignResponse& r) {
        Eigen::VectorXd all(r.force.size() + r.markers.size());
        all << r.force, r.markers;
        return all;
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
    /// Which columns one deviation of each of a rival's numbers is made of.
    [[nodiscard]] Eigen::MatrixXd deviations(std::size_t rival) const {
        const Eigen::LLT<Eigen::MatrixXd> llt(rivals_[rival].covariance);
        const Eigen::MatrixXd factor =
            llt.info() == Eigen::Success
                ? Eigen::MatrixXd(llt.matrixL())
                : Eigen::MatrixXd(rivals_[rival].covariance.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal());
        const auto n = static_cast<Index>(rivals_.size());
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(columns_.cols(), factor.cols());
        out.middleRows(n, nominal_) = factor.topRows(nominal_);
        out.middleRows(n + own_[rival], factor.rows() - nominal_) = factor.bottomRows(factor.rows() - nominal_);
        return out;
    }
    /// @param a what is true @param b what is refitted
    [[nodiscard]] Told refuted(const Eigen::MatrixXd& sums, std::size_t a, std::size_t b, bool refit) const {
        Eigen::VectorXd apart = Eigen::VectorXd::Zero(sums.cols());
        apart[static_cast<Index>(a)] = 1.0;
        apart[static_cast<Index>(b)] = -1.0;
        const Eigen::VectorXd seen = sums * apart;
        if (!refit)
            return {std::sqrt(std::max(0.0, apart.dot(seen)))};
        const Eigen::MatrixXd of = deviations(a), by = deviations(b);
        const Eigen::MatrixXd inner = Eigen::MatrixXd::Identity(by.cols(), by.cols()) + by.transpose() * sums * by;
        const Eigen::VectorXd left = seen - sums * by * inner.ldlt().solve(by.transpose() * seen);
        const double square = apart.dot(left);
        if (!std::isfinite(square) || square <= 0.0)
            return {};
        return {std::sqrt(square), (of.transpose() * left).norm() / std::sqrt(square),
                std::sqrt(std::max(0.0, 1.0 - (by.transpose() * left).squaredNorm() / square))};
    }

    Evaluator& evaluator_;
    std::size_t index_;
    const Design& design_;
    const Noise& noise_;
    const std::vector<Rival>& rivals_;
    std::vector<DesignResponse> responses_; ///< of the rivals
    /// Readings of the rivals, their derivatives by nominal parameters and by each rival's own numbers, N and m.
    Eigen::MatrixXd columns_;
    Index nominal_ = 0;      ///< number of nominal parameters
    std::vector<Index> own_; ///< first derivative by a rival's own numbers
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

Offer offerOf(const Foretold& run, const std::vector<Rival>& rivals, std::size_t repeats, bool refit) {
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
    const Offer farthest = offerOf(run, rivals, most, true);
    Offer out = farthest;
    for (std::size_t n = 1; n < most; ++n)
        if (const Offer offer = offerOf(run, rivals, n, true);
            offer.enough() || (!farthest.enough() && offer.worth >= kNearly * farthest.worth)) {
            out = offer;
            break;
        }
    out.promise = farthest.worth;
    return out;
}

} // namespace

std::optional<NextExperiment> nextExperiment(Evaluator& evaluator, const std::vector<Rival>& rivals,
                                             const Noise& noise) {
    if (noise.total() <= 0.0 || rivals.size() < 2)
        return std::nullopt;
    constexpr double kLittle = 0.25; // of what is enough: less is not worth derivatives
    Offer best;
    NextExperiment out;
    const std::vector<Design> designs = evaluator.model().designs();
    for (std::size_t i = 0; i < designs.size() && !evaluator.stopped(); ++i) {
        if (best.enough() && best.repeats == 1)
            break; // the first one listed is the simplest
        Foretold run(evaluator, i, designs[i], noise, rivals);
        const std::size_t most = best.enough() ? best.repeats - 1 : kMostRepeats;
        if (!run.simulate() ||
            offerOf(run, rivals, most, false).worth < std::max(kLittle, std::min(kAll, best.promise)))
            continue;
        run.differentiate();
        if (const Offer offer = bestOffer(run, rivals, most); offer.better(best)) {
            best = offer;
            out.run = designs[i];
        }
    }
    if (best.worth <= 0.0 || evaluator.stopped())
        return std::nullopt;
    out.repeats = best.repeats;
    for (const Rival& r : rivals)
        if (r.otherSide)
            out.side = true;
        else
            out.separates.push_back(r.label);
    out.power = best.power;
    return out;
}

std::string noneTells(const Diagnosis& d) {
    return "None of the " + std::to_string(d.nextTried) + " further runs that were looked at, made up to " +
           std::to_string(kMostRepeats) +
           " times, would tell: it takes a reading with less noise, or stated numbers that are better known.";
}

std::string inWords(const NextExperiment& next) {
    return next.run.what + (next.repeats > 1 ? ", made " + std::to_string(next.repeats) + " times" : "");
}

} // namespace supercircle::diagnosis
