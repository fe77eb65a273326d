#include "plugin/identification/diagnosis/next_experiment/predicted_run.h"

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
        for (Index k = i == 0 ? 0 : nominal; k < v.size(); ++k)
            items_.push_back({i, k});
        const Eigen::LLT<Eigen::MatrixXd> llt(competing[i].covariance);
        factor_.emplace_back(
            llt.info() == Eigen::Success
                ? Eigen::MatrixXd(llt.matrixL())
                : Eigen::MatrixXd(competing[i].covariance.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal()));
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
        y[n.index] += step;
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
    return whitened ? Eigen::VectorXd(std::sqrt(static_cast<double>(repeats)) * *whitened) : Eigen::VectorXd();
}

Eigen::MatrixXd PredictedRun::derivatives(const RunLikelihood& likelihood, std::size_t repeats) const {
    Eigen::MatrixXd out;
    for (std::size_t k = 0; k < varied_.size(); ++k) {
        const CandidateRunResponse& from = responses_[uncertain_.items()[k].hypothesis];
        const CandidateRunResponse& to = usable(varied_[k].response) ? varied_[k].response : from;
        const auto change = likelihood.difference(to, from);
        if (!change)
            continue;
        if (out.size() == 0)
            out.setZero(change->size(), uncertain_.size());
        out.col(static_cast<Index>(k)) = std::sqrt(static_cast<double>(repeats)) / varied_[k].step * *change;
    }
    return out;
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
