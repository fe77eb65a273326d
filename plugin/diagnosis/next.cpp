#include "plugin/diagnosis/next.h"

#include "plugin/diagnosis/whitening.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// A run that was not made, as two rivals foretell it.
class Foretold {
public:
    Foretold(const Model& model, std::size_t design, const Noise& noise)
        : model_(model), design_(design), noise_(noise) {}

    /// In units of what is not known about it; 0: it cannot be simulated.
    double distance(const Rival& a, const Rival& b) {
        const DesignResponse first = model_.simulateDesign(design_, a.point, nullptr);
        const DesignResponse second = model_.simulateDesign(design_, b.point, nullptr);
        if (!first.failure.empty() || !second.failure.empty() || first.force.size() != second.force.size() ||
            first.force.size() < 8)
            return 0.0;
        // What no simulation is better than, for a tenth of a leg at a time: many readings do not average it away.
        const double peak = first.force.cwiseAbs().maxCoeff(), span = first.time[first.time.size() - 1] - first.time[0];
        white_.emplace(first.time, noise_.white, noise_.coloured, noise_.memory,
                       Eigen::VectorXd::Constant(first.force.size(), MisfitSettings{}.shareOfPeak * peak),
                       std::clamp(0.05 * span, 0.02, 3.0));
        const Eigen::VectorXd one = white_->apply(Eigen::VectorXd::Ones(first.force.size()));
        shift_ = one / one.norm();
        const Eigen::VectorXd apart = whitened(first.force - second.force);
        if (!apart.allFinite() || apart.norm() < kLittle)
            return 0.0;
        const Variables va(model_, a.point), vb(model_, b.point);
        Eigen::MatrixXd ja(apart.size(), va.size()), jb(apart.size(), vb.size());
        for (Index k = 0; k < va.size(); ++k)
            ja.col(k) = derivative(va, a.x, k, first);
        jb.leftCols(vb.nominal) = ja.leftCols(vb.nominal); // nominal parameters do much the same in either
        for (Index k = vb.nominal; k < vb.size(); ++k)
            jb.col(k) = derivative(vb, b.x, k, second);
        Eigen::MatrixXd spread(apart.size(), va.size() + vb.size());
        spread << ja * Eigen::MatrixXd(a.covariance.llt().matrixL()),
            jb * Eigen::MatrixXd(b.covariance.llt().matrixL());
        const Eigen::MatrixXd inner =
            Eigen::MatrixXd::Identity(spread.cols(), spread.cols()) + spread.transpose() * spread;
        const Eigen::VectorXd along = spread.transpose() * apart;
        const double square = apart.squaredNorm() - along.dot(inner.ldlt().solve(along));
        return std::isfinite(square) ? std::sqrt(std::max(0.0, square)) : 0.0;
    }

private:
    static constexpr double kLittle = 1.0; ///< noise units: less is not worth derivatives
    static constexpr double kStep = 0.2;   ///< of x

    [[nodiscard]] Eigen::VectorXd whitened(const Eigen::VectorXd& force) const {
        const Eigen::VectorXd u = white_->apply(force);
        return u - shift_ * shift_.dot(u);
    }
    /// d(whitened readings)/dx_k to the side that has room; zero where it cannot be simulated.
    [[nodiscard]] Eigen::VectorXd derivative(const Variables& v, const Eigen::VectorXd& x, Index k,
                                             const DesignResponse& at) const {
        Eigen::VectorXd y = x;
        const double step = x[k] + kStep <= v.upper[k] ? kStep : -kStep;
        y[k] += step;
        const DesignResponse moved = model_.simulateDesign(design_, v.at(y), nullptr);
        if (!moved.failure.empty() || moved.force.size() != at.force.size())
            return Eigen::VectorXd::Zero(at.force.size());
        const Eigen::VectorXd change = whitened(moved.force - at.force) / step;
        return change.allFinite() ? change : Eigen::VectorXd::Zero(change.size());
    }

    const Model& model_;
    std::size_t design_;
    const Noise& noise_;
    std::optional<Whitening> white_;
    Eigen::VectorXd shift_; ///< whitened constant shift, of length 1
};

} // namespace

std::optional<NextExperiment> nextExperiment(const Model& model, const std::vector<Rival>& rivals, const Noise& noise,
                                             const std::vector<std::string>& group) {
    if (rivals.size() < 2 || noise.total() <= 0.0)
        return std::nullopt;
    // A rival that these runs cannot tell from the first is the one that matters.
    std::size_t other = 1;
    for (std::size_t i = 1; i < rivals.size(); ++i)
        if (std::find(group.begin() + 1, group.end(), rivals[i].label) != group.end()) {
            other = i;
            break;
        }
    double farthest = 0.0;
    NextExperiment best;
    const std::vector<Design> designs = model.designs();
    constexpr double kEnough =
        5.0; // noise units beyond which runs are all as good: the first one listed is the simplest
    for (std::size_t i = 0; i < designs.size() && farthest < kEnough; ++i) {
        const double d = Foretold(model, i, noise).distance(rivals[0], rivals[other]);
        if (d > farthest) {
            farthest = d;
            best.run = designs[i];
        }
    }
    if (farthest <= 0.0)
        return std::nullopt;
    best.separates = {rivals[0].label, rivals[other].label};
    best.power = boost::math::cdf(boost::math::normal(), farthest - 1.6448536269514722);
    return best;
}

} // namespace supercircle::diagnosis
