#include "plugin/identification/diagnosis/estimation/sandwich.h"
#include "supercircle/support/dense.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <map>
#include <tuple>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Rows of one stroke of one run, each channel for itself.
std::map<std::tuple<std::size_t, std::size_t, std::size_t>, std::vector<Index>> blocksOf(const Likelihood& likelihood) {
    std::map<std::tuple<std::size_t, std::size_t, std::size_t>, std::vector<Index>> out;
    for (std::size_t r = 0; r < likelihood.runs(); ++r)
        for (Index k = 0; k < likelihood.rowsOf(r); ++k)
            if (likelihood.counts(r, k))
                out[{r, likelihood.stroke(r, k), likelihood.channelOf(r, k)}].push_back(likelihood.start(r) + k);
    return out;
}

} // namespace

Eigen::VectorXd dispersionsOf(const Likelihood& likelihood, const Variables& v, const Eigen::VectorXd& residual,
                              const Eigen::MatrixXd& jacobian, double perReading) {
    constexpr double kPromised = 4.0;       // prior weight of the model-based variance, in strokes
    constexpr double kLeastOfItsOwn = 0.02; // lower bound of 1 - leverage of a stroke
    const double least = std::max(1.0, perReading);
    Eigen::VectorXd out = Eigen::VectorXd::Constant(v.size(), least);
    if (v.size() == 0 || residual.size() != jacobian.rows())
        return out;
    const Eigen::MatrixXd covariance = posteriorCovariance(v, jacobian, 1.0);
    const dense::SymmetricEigen eigen = dense::symmetricEigen(covariance);
    const Eigen::MatrixXd root =
        eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.vectors.transpose();
    Eigen::VectorXd scatter = Eigen::VectorXd::Zero(v.size()), promised = scatter, squares = scatter;
    for (const auto& [block, rows] : blocksOf(likelihood)) {
        const Eigen::MatrixXd J = jacobian(rows, Eigen::all);
        const Eigen::MatrixXd information = J.transpose() * J;
        const dense::SymmetricEigen share = dense::symmetricEigen(root * information * root);
        const Eigen::VectorXd own = (1.0 - share.values.array()).cwiseMax(kLeastOfItsOwn).rsqrt();
        const Eigen::VectorXd pull = J.transpose() * residual(rows);
        const Eigen::VectorXd step =
            root * (share.vectors * own.asDiagonal() * (share.vectors.transpose() * (root * pull)));
        const Eigen::VectorXd expected = (covariance * information * covariance).diagonal();
        scatter += step.cwiseAbs2();
        promised += expected;
        squares += expected.cwiseAbs2();
    }
    for (Index k = 0; k < v.size(); ++k)
        if (promised[k] > 0.0 && std::isfinite(scatter[k])) {
            const double strokes = promised[k] * promised[k] / squares[k]; // effective number of strokes
            out[k] = std::max(least, (strokes * scatter[k] / promised[k] + kPromised * least) / (strokes + kPromised));
            const double t = quantile(boost::math::students_t(strokes + kPromised), 0.95) / k90;
            out[k] *= t * t;
        }
    return out;
}

} // namespace supercircle::diagnosis
