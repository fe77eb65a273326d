#include "plugin/identification/diagnosis/next_experiment/predicted_run.h"

#include "supercircle/support/dense.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

} // namespace

UncertainParameters::UncertainParameters(const Model& model, const std::vector<CompetingHypothesis>& competing) {
    std::vector<Index> own; // first index of each hypothesis' own parameters
    Index nominal = 0;
    for (std::size_t i = 0; i < competing.size(); ++i) {
        const Variables v(model, competing[i].point);
        nominal = v.nominal;
        own.push_back(i == 0 ? nominal : size());
        Eigen::MatrixXd covariance = competing[i].covariance;
        for (Index k = i == 0 ? 0 : nominal; k < v.size(); ++k) {
            const double precision = v.intervalPrecision(k, 1e3) + (k < nominal ? v.scalar(k).precision : 0.0);
            items_.push_back({i, k, k < nominal ? v.scalar(k).run : -1, 1.0 / std::sqrt(precision)});
        }
        for (Index k = 0; k < nominal; ++k)
            if (v.scalar(k).run >= 0) {
                covariance.row(k).setZero();
                covariance.col(k).setZero();
                covariance(k, k) = 1.0; // so that there is a square root
            }
        const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
        factor_.emplace_back(llt.info() == Eigen::Success
                                 ? Eigen::MatrixXd(llt.matrixL())
                                 : Eigen::MatrixXd(covariance.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal()));
        for (Index k = 0; k < nominal; ++k)
            if (v.scalar(k).run >= 0)
                factor_.back()(k, k) = 0.0;
    }
    for (std::size_t i = 0; i < competing.size(); ++i) {
        const Eigen::MatrixXd& f = factor_[i];
        const Index its = f.rows() - nominal;
        factorByItem_.emplace_back(Eigen::MatrixXd::Zero(size(), f.cols()));
        factorByItem_.back().topRows(nominal) = f.topRows(nominal);
        factorByItem_.back().middleRows(own[i], its) = f.bottomRows(its);
    }
}

bool PredictedRun::usable(const CandidateRunResponse& r) const {
    return r.failure.empty() && r.force.size() == responses_.front().force.size() &&
           r.markers.size() == responses_.front().markers.size() &&
           r.further.size() == responses_.front().further.size();
}

bool PredictedRun::simulate() {
    std::vector<ParameterPoint> points;
    for (const CompetingHypothesis& r : competing_)
        points.push_back(r.point);
    responses_ = at(points);
    return responses_.front().force.size() >= 8 &&
           std::all_of(responses_.begin(), responses_.end(), [&](const CandidateRunResponse& r) { return usable(r); });
}

void PredictedRun::differentiate() {
    if (!varied_.empty())
        return;
    constexpr double kStep = 0.2; // of x
    std::vector<ParameterPoint> points;
    for (const UncertainParameters::Item& n : uncertain_.items()) {
        const CompetingHypothesis& r = competing_[n.hypothesis];
        const Variables v(evaluator_.model(), r.point);
        Eigen::VectorXd y = r.x;
        const double step = r.x[n.index] + kStep <= v.upper[n.index] ? kStep : -kStep; // away from the bound
        y[n.index] += n.run < 0 || static_cast<std::size_t>(n.run) == candidateRun_.run ? step : 0.0;
        points.push_back(v.at(y));
        varied_.push_back({step, {}});
    }
    auto there = at(points);
    for (std::size_t k = 0; k < there.size(); ++k) { // try the other side where the simulation fails
        const UncertainParameters::Item& n = uncertain_.items()[k];
        const CompetingHypothesis& r = competing_[n.hypothesis];
        const Variables v(evaluator_.model(), r.point);
        Eigen::VectorXd y = r.x;
        y[n.index] -= varied_[k].step;
        if (!usable(there[k]) && y[n.index] >= v.lower[n.index] && y[n.index] <= v.upper[n.index]) {
            varied_[k].step = -varied_[k].step;
            there[k] = at({v.at(y)}).front();
        }
        varied_[k].response = std::move(there[k]);
    }
    gram_.clear();
}

std::unique_ptr<RunLikelihood> PredictedRun::likelihoodOf(std::size_t truth, std::size_t repeats) const {
    return std::make_unique<RunLikelihood>(candidateRun_, responses_[truth], noise_, zeroWindow_, repeats);
}

Eigen::VectorXd PredictedRun::difference(const RunLikelihood& likelihood, std::size_t repeats, std::size_t truth,
                                         const CandidateRunResponse& alternative) const {
    const auto whitened = usable(alternative) ? likelihood.difference(responses_[truth], alternative) : std::nullopt;
    return whitened ? Eigen::VectorXd(std::sqrt(static_cast<double>(repeats)) * withoutOwn(likelihood, *whitened))
                    : Eigen::VectorXd();
}

std::optional<Eigen::VectorXd> PredictedRun::changeBy(const RunLikelihood& likelihood, std::size_t item) const {
    const CandidateRunResponse& from = responses_[uncertain_.items()[item].hypothesis];
    const CandidateRunResponse& to = usable(varied_[item].response) ? varied_[item].response : from;
    return likelihood.difference(to, from);
}

Eigen::MatrixXd PredictedRun::withoutOwn(const RunLikelihood& likelihood, const Eigen::MatrixXd& readings) const {
    Eigen::MatrixXd own(readings.rows(), 0); // by one standard deviation of each
    for (std::size_t k = 0; k < varied_.size(); ++k) {
        const UncertainParameters::Item& n = uncertain_.items()[k];
        if (n.run < 0 || static_cast<std::size_t>(n.run) != candidateRun_.run)
            continue;
        if (const auto change = changeBy(likelihood, k); change && change->size() == readings.rows()) {
            own.conservativeResize(Eigen::NoChange, own.cols() + 1);
            own.rightCols(1) = n.deviation / varied_[k].step * *change;
        }
    }
    if (own.cols() == 0)
        return readings;
    // (1 + own own')^-1/2 by the small matrix own' own
    const dense::SymmetricEigen eigen = dense::symmetricEigen(own.transpose() * own);
    const Eigen::ArrayXd root = (1.0 + eigen.values.array().max(0.0)).sqrt();
    const Eigen::MatrixXd along = own * eigen.vectors;
    return readings - along * (1.0 / (root * (1.0 + root))).matrix().asDiagonal() * (along.transpose() * readings);
}

Eigen::MatrixXd PredictedRun::derivatives(const RunLikelihood& likelihood, std::size_t repeats) const {
    Eigen::MatrixXd out;
    for (std::size_t k = 0; k < varied_.size(); ++k) {
        const auto change = changeBy(likelihood, k);
        if (!change)
            continue;
        if (out.size() == 0)
            out.setZero(change->size(), uncertain_.size());
        out.col(static_cast<Index>(k)) = std::sqrt(static_cast<double>(repeats)) / varied_[k].step * *change;
    }
    return withoutOwn(likelihood, out);
}

const Eigen::MatrixXd& PredictedRun::gram(std::size_t truth, std::size_t repeats) {
    const auto [at, fresh] = gram_.try_emplace({truth, repeats});
    if (!fresh)
        return at->second;
    const auto likelihood = likelihoodOf(truth, repeats);
    const Eigen::MatrixXd by = derivatives(*likelihood, repeats);
    std::vector<Eigen::VectorXd> from;
    Index rows = by.rows();
    for (std::size_t b = 0; b < competing_.size(); ++b) {
        from.push_back(difference(*likelihood, repeats, truth, b));
        rows = std::max(rows, from.back().size());
    }
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, uncertain_.size() + static_cast<Index>(competing_.size()));
    if (by.size() > 0)
        all.leftCols(uncertain_.size()) = by;
    for (std::size_t b = 0; b < from.size(); ++b)
        if (from[b].size() > 0)
            all.col(uncertain_.size() + static_cast<Index>(b)) = from[b];
    return at->second = all.transpose() * all;
}

} // namespace supercircle::diagnosis
