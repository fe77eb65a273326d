#include "plugin/identification/diagnosis/estimation/scatter.h"

#include "supercircle/support/dense.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr std::size_t kFewest = 3; ///< specimens that tell a standard deviation at all

/// Log marginal likelihood as a function of the scatters, up to a constant.
class Marginal {
public:
    Marginal(const Model& model, const Likelihood& likelihood, const FitResult& f)
        : v_(model, f.point), x_(f.x), dispersion_(std::max(1.0, chiSquaredPerReading(likelihood, f))) {
        information_ = f.jacobian.transpose() * f.jacobian / dispersion_;
        slope_ = f.jacobian.transpose() * f.residual / dispersion_;
    }

    [[nodiscard]] double operator()(const std::vector<double>& scatter) const {
        constexpr double kOpen = 1e3; // half-width, in steps, of a parameter without bounds
        Eigen::VectorXd prior(v_.size());
        for (Index i = 0; i < v_.size(); ++i) {
            const int factor = i < v_.nominal ? v_.scalar(i).batch : -1;
            prior[i] =
                factor >= 0
                    ? 1.0 / (scatter[static_cast<std::size_t>(factor)] * scatter[static_cast<std::size_t>(factor)])
                    : v_.intervalPrecision(i, 2.0 * kOpen) + (i < v_.nominal ? v_.scalar(i).precision : 0.0);
        }
        const Eigen::VectorXd root = prior.cwiseSqrt();
        // Scaled by the prior, all eigenvalues are at least 1.
        const dense::SymmetricEigen eigen = dense::symmetricEigen(
            Eigen::MatrixXd(root.cwiseInverse().asDiagonal() * information_ * root.cwiseInverse().asDiagonal()));
        const Eigen::VectorXd g = eigen.vectors.transpose() * (slope_ - prior.cwiseProduct(x_)).cwiseQuotient(root);
        double twice = -x_.dot(prior.cwiseProduct(x_));
        for (Index i = 0; i < g.size(); ++i) {
            const double e = 1.0 + std::max(0.0, eigen.values[i]);
            twice += g[i] * g[i] / e - math::log(e);
        }
        return 0.5 * twice;
    }

private:
    Variables v_;
    const Eigen::VectorXd& x_;
    double dispersion_;
    Eigen::MatrixXd information_;
    Eigen::VectorXd slope_;
};

/// Quantiles of a density on a grid.
double quantile(const std::vector<double>& at, const std::vector<double>& cumulated, double share) {
    const double wanted = share * cumulated.back();
    const auto i =
        static_cast<std::size_t>(std::lower_bound(cumulated.begin(), cumulated.end(), wanted) - cumulated.begin());
    if (i == 0)
        return at.front();
    const double part = (wanted - cumulated[i - 1]) / std::max(1e-300, cumulated[i] - cumulated[i - 1]);
    return at[i - 1] + part * (at[i] - at[i - 1]);
}

/// Posterior of one scatter, the others held.
/// @param logLikelihood of a scatter
template <class LogLikelihood>
Scatter posteriorOf(const LogLikelihood& logLikelihood) {
    constexpr int kPoints = 160;
    constexpr double kLeast = 1e-3, kMost = 5.0; // of the scale; the prior leaves 6e-7 beyond
    std::vector<double> at, logs;
    for (int i = 0; i <= kPoints; ++i) {
        at.push_back(kLeast * math::pow(kMost / kLeast, static_cast<double>(i) / kPoints));
        logs.push_back(logLikelihood(at.back()) - 0.5 * at.back() * at.back());
    }
    const double most = *std::max_element(logs.begin(), logs.end());
    std::vector<double> cumulated = {0.0};
    for (std::size_t i = 1; i < at.size(); ++i)
        cumulated.push_back(cumulated.back() +
                            0.5 * (math::exp(logs[i] - most) + math::exp(logs[i - 1] - most)) * (at[i] - at[i - 1]));
    Scatter s;
    s.median = quantile(at, cumulated, 0.5);
    s.low = quantile(at, cumulated, 0.05);
    s.high = quantile(at, cumulated, 0.95);
    s.evidence = most + math::log(cumulated.back() * std::sqrt(2.0 / M_PI)) - logs.front();
    return s;
}

} // namespace

std::vector<Scatter> scattersOf(const Model& model, const Likelihood& likelihood, const FitResult& f) {
    const std::size_t factors = model.batch().size();
    std::vector<Scatter> out(factors);
    std::vector<double> at = f.point.scatter;
    at.resize(factors, 1.0);
    for (const Scalar& s : model.nominal())
        if (s.batch >= 0)
            ++out[static_cast<std::size_t>(s.batch)].specimens;
    const Marginal marginal(model, likelihood, f);
    const int rounds = factors > 1 ? 3 : 1;
    for (int round = 0; round < rounds; ++round)
        for (std::size_t k = 0; k < factors; ++k) {
            const std::size_t specimens = out[k].specimens;
            const bool isPrior = specimens < kFewest;
            out[k] = posteriorOf([&](double scatter) {
                std::vector<double> there = at;
                there[k] = scatter;
                return isPrior ? 0.0 : marginal(there);
            });
            out[k].specimens = specimens;
            out[k].isPrior = isPrior;
            at[k] = out[k].median;
        }
    return out;
}

bool settleScatter(Evaluator& evaluator, const Likelihood& likelihood, FitResult& fitted) {
    constexpr int kRounds = 3;
    constexpr double kStays = 0.1; // relative
    for (int round = 0; round < kRounds; ++round) {
        ParameterPoint next = fitted.point;
        next.scatter.clear();
        bool stays = true;
        for (const Scatter& s : scattersOf(evaluator.model(), likelihood, fitted)) {
            const std::size_t k = next.scatter.size();
            const double before = k < fitted.point.scatter.size() ? fitted.point.scatter[k] : 1.0;
            stays = stays && std::abs(s.median - before) < kStays * before;
            next.scatter.push_back(s.median);
        }
        if (stays)
            return true;
        FitSettings from;
        from.progressive = false;
        FitResult again = fit(evaluator, likelihood, next, from);
        if (!again.failure.empty() || evaluator.stopped())
            return false;
        fitted = std::move(again);
    }
    return true;
}

} // namespace supercircle::diagnosis
