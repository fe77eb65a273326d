#include "plugin/diagnosis/next.h"

#include "plugin/diagnosis/misfit.h"
#include "plugin/diagnosis/whitening.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// How far the machine goes from row to row around each, m; 0 without a machine.
Eigen::VectorXd ways(const Design& design, const Eigen::VectorXd& time) {
    const auto at = [&](double t) { // of the head
        std::size_t i = 1;
        while (i + 1 < design.time.size() && design.time[i] < t)
            ++i;
        const double share = (t - design.time[i - 1]) / (design.time[i] - design.time[i - 1]);
        return design.displacement[i - 1] +
               std::clamp(share, 0.0, 1.0) * (design.displacement[i] - design.displacement[i - 1]);
    };
    Eigen::VectorXd out = Eigen::VectorXd::Zero(time.size());
    for (Index k = 1; k < time.size() && design.time.size() > 1; ++k)
        out[k] = std::abs(at(time[k]) - at(time[k - 1]));
    return out;
}

/// A run that was not made, as two rivals foretell it.
class Foretold {
public:
    Foretold(Evaluator& evaluator, std::size_t index, const Design& design, const Noise& noise)
        : evaluator_(evaluator), index_(index), design_(design), noise_(noise) {}

    /// In units of what is not known about it; 0: it cannot be simulated, or is not more than `least`, which their
    /// plain distance shows before any derivative is taken (a dozen simulations a design).
    double distance(const Rival& a, const Rival& b, double least) {
        const auto both = evaluator_.foretell(index_, {a.point, b.point});
        const DesignResponse &first = both[0], &second = both[1];
        if (!first.failure.empty() || !second.failure.empty() || first.force.size() != second.force.size() ||
            first.force.size() < 8)
            return 0.0;
        // What no simulation is better than, for a tenth of a leg at a time: many readings do not average it away.
        const double peak = first.force.cwiseAbs().maxCoeff(), span = first.time[first.time.size() - 1] - first.time[0];
        white_.emplace(first.time, noise_.white, noise_.coloured, noise_.memory,
                       errorsOf(first.force, ways(design_, first.time), design_.doubt * kCoarse * peak),
                       std::clamp(0.05 * span, 0.02, 3.0));
        const Eigen::VectorXd one = white_->apply(Eigen::VectorXd::Ones(first.force.size()));
        shift_ = one / one.norm();
        const Eigen::VectorXd apart = whitened(first.force - second.force);
        if (!apart.allFinite() || apart.norm() < std::max(kLittle, least))
            return 0.0;
        const Variables va(evaluator_.model(), a.point), vb(evaluator_.model(), b.point);
        Moved moved;
        moved.add(va, a.x, 0, first);
        moved.add(vb, b.x, vb.nominal, second); // nominal parameters do much the same in either
        const Eigen::MatrixXd all = derivatives(moved);
        Eigen::MatrixXd jb(apart.size(), vb.size());
        jb << all.leftCols(vb.nominal), all.rightCols(vb.size() - vb.nominal);
        Eigen::MatrixXd spread(apart.size(), va.size() + vb.size() + 2);
        spread << all.leftCols(va.size()) * Eigen::MatrixXd(a.covariance.llt().matrixL()),
            jb * Eigen::MatrixXd(b.covariance.llt().matrixL()), ownOf(first.force);
        const Eigen::MatrixXd inner =
            Eigen::MatrixXd::Identity(spread.cols(), spread.cols()) + spread.transpose() * spread;
        const Eigen::VectorXd along = spread.transpose() * apart;
        const double square = apart.squaredNorm() - along.dot(inner.ldlt().solve(along));
        return std::isfinite(square) ? std::sqrt(std::max(0.0, square)) : 0.0;
    }

private:
    static constexpr double kLittle = 1.0;  ///< noise units: less is not worth derivatives
    static constexpr double kCoarse = 1e-3; ///< accuracy of a simulation that nothing corrects, share of the peak

    /// Points beside a rival's, one for each number, to the side that has room.
    struct Moved {
        static constexpr double kStep = 0.2; ///< of x
        std::vector<Point> points;
        std::vector<double> steps;
        std::vector<const DesignResponse*> from;

        void add(const Variables& v, const Eigen::VectorXd& x, Index first, const DesignResponse& at) {
            for (Index k = first; k < v.size(); ++k) {
                Eigen::VectorXd y = x;
                steps.push_back(x[k] + kStep <= v.upper[k] ? kStep : -kStep);
                y[k] += steps.back();
                points.push_back(v.at(y));
                from.push_back(&at);
            }
        }
    };

    /// Errors of the simulated force in each row, N.
    [[nodiscard]] Eigen::VectorXd errorsOf(const Eigen::VectorXd& force, const Eigen::VectorXd& way,
                                           double everywhere) const {
        Eigen::VectorXd out(force.size());
        for (Index k = 0; k < out.size(); ++k)
            out[k] = std::hypot(everywhere, placeError(force, k, way[k], settings_));
        return out;
    }
    /// What the run has of its own, as a recorded one has (misfit.h): clock and scale.
    [[nodiscard]] Eigen::MatrixXd ownOf(const Eigen::VectorXd& force) const {
        Eigen::VectorXd clock = Eigen::VectorXd::Zero(force.size());
        clock.segment(1, force.size() - 2) = 0.5 * (force.tail(force.size() - 2) - force.head(force.size() - 2));
        Eigen::MatrixXd own(force.size(), 2);
        own << whitened(settings_.clock * clock), whitened((design_.time.empty() ? 0.0 : settings_.scale) * force);
        return own;
    }
    [[nodiscard]] Eigen::VectorXd whitened(const Eigen::VectorXd& force) const {
        const Eigen::VectorXd u = white_->apply(force);
        return u - shift_ * shift_.dot(u);
    }
    /// d(whitened readings)/dx, a column each; zero where it cannot be simulated.
    [[nodiscard]] Eigen::MatrixXd derivatives(const Moved& moved) {
        const auto there = evaluator_.foretell(index_, moved.points);
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(shift_.size(), static_cast<Index>(there.size()));
        for (std::size_t k = 0; k < there.size(); ++k) {
            if (!there[k].failure.empty() || there[k].force.size() != shift_.size())
                continue;
            const Eigen::VectorXd change = whitened(there[k].force - moved.from[k]->force) / moved.steps[k];
            if (change.allFinite())
                out.col(static_cast<Index>(k)) = change;
        }
        return out;
    }

    Evaluator& evaluator_;
    std::size_t index_;
    const Design& design_;
    const Noise& noise_;
    MisfitSettings settings_;
    std::optional<Whitening> white_;
    Eigen::VectorXd shift_; ///< whitened constant shift, of length 1
};

} // namespace

std::optional<NextExperiment> nextExperiment(Evaluator& evaluator, const std::array<Rival, 2>& rivals,
                                             const Noise& noise) {
    if (noise.total() <= 0.0)
        return std::nullopt;
    double farthest = 0.0;
    NextExperiment best;
    const std::vector<Design> designs = evaluator.model().designs();
    constexpr double kEnough =
        5.0; // noise units beyond which runs are all as good: the first one listed is the simplest
    for (std::size_t i = 0; i < designs.size() && farthest < kEnough && !evaluator.stopped(); ++i) {
        const double d = Foretold(evaluator, i, designs[i], noise).distance(rivals[0], rivals[1], farthest);
        if (d > farthest) {
            farthest = d;
            best.run = designs[i];
        }
    }
    if (farthest <= 0.0 || evaluator.stopped())
        return std::nullopt;
    best.separates = {rivals[0].label, rivals[1].label};
    best.power = boost::math::cdf(boost::math::normal(), farthest - 1.6448536269514722);
    return best;
}

} // namespace supercircle::diagnosis
