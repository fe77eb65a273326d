#include "plugin/identification/diagnosis/next_experiment/foretold.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

} // namespace

Open::Open(const Model& model, const std::vector<Rival>& rivals) {
    std::vector<Index> own; // where a rival's own numbers begin
    Index nominal = 0;
    for (std::size_t i = 0; i < rivals.size(); ++i) {
        const Variables v(model, rivals[i].point);
        nominal = v.nominal;
        own.push_back(i == 0 ? nominal : size());
        for (Index k = i == 0 ? 0 : nominal; k < v.size(); ++k)
            numbers_.push_back({i, k});
        const Eigen::LLT<Eigen::MatrixXd> llt(rivals[i].covariance);
        factor_.emplace_back(
            llt.info() == Eigen::Success
                ? Eigen::MatrixXd(llt.matrixL())
                : Eigen::MatrixXd(rivals[i].covariance.diagonal().cwiseMax(0.0).cwiseSqrt().asDiagonal()));
    }
    for (std::size_t i = 0; i < rivals.size(); ++i) {
        const Eigen::MatrixXd& f = factor_[i];
        const Index its = f.rows() - nominal;
        deviations_.emplace_back(Eigen::MatrixXd::Zero(size(), f.cols()));
        deviations_.back().topRows(nominal) = f.topRows(nominal);
        deviations_.back().middleRows(own[i], its) = f.bottomRows(its);
    }
}

bool Foretold::usable(const DesignResponse& r) const {
    return r.failure.empty() && r.force.size() == responses_.front().force.size() &&
           r.markers.size() == responses_.front().markers.size();
}

bool Foretold::simulate() {
    std::vector<Point> points;
    for (const Rival& r : rivals_)
        points.push_back(r.point);
    responses_ = at(points);
    return responses_.front().force.size() >= 8 &&
           std::all_of(responses_.begin(), responses_.end(), [&](const DesignResponse& r) { return usable(r); });
}

void Foretold::differentiate() {
    if (!moved_.empty())
        return;
    constexpr double kStep = 0.2; // of x
    std::vector<Point> points;
    for (const Open::Number& n : open_.numbers()) {
        const Rival& r = rivals_[n.rival];
        const Variables v(evaluator_.model(), r.point);
        Eigen::VectorXd y = r.x;
        const double step = r.x[n.number] + kStep <= v.upper[n.number] ? kStep : -kStep; // to the side that has room
        y[n.number] += step;
        points.push_back(v.at(y));
        moved_.push_back({step, {}});
    }
    auto there = at(points);
    for (std::size_t k = 0; k < there.size(); ++k) { // what fails may be simulated to the other side
        const Open::Number& n = open_.numbers()[k];
        const Rival& r = rivals_[n.rival];
        const Variables v(evaluator_.model(), r.point);
        Eigen::VectorXd y = r.x;
        y[n.number] -= moved_[k].step;
        if (!usable(there[k]) && y[n.number] >= v.lower[n.number] && y[n.number] <= v.upper[n.number]) {
            moved_[k].step = -moved_[k].step;
            there[k] = at({v.at(y)}).front();
        }
        moved_[k].response = std::move(there[k]);
    }
    products_.clear();
}

std::unique_ptr<Sight> Foretold::sightOf(std::size_t is, std::size_t repeats) const {
    return std::make_unique<Sight>(design_, responses_[is], noise_, zeroWindow_, repeats);
}

Eigen::VectorXd Foretold::apart(const Sight& sight, std::size_t repeats, std::size_t is,
                                const DesignResponse& said) const {
    const auto seen = usable(said) ? sight.apart(responses_[is], said) : std::nullopt;
    return seen ? Eigen::VectorXd(std::sqrt(static_cast<double>(repeats)) * *seen) : Eigen::VectorXd();
}

Eigen::MatrixXd Foretold::changes(const Sight& sight, std::size_t repeats) const {
    Eigen::MatrixXd out;
    for (std::size_t k = 0; k < moved_.size(); ++k) {
        const DesignResponse& from = responses_[open_.numbers()[k].rival];
        const DesignResponse& to = usable(moved_[k].response) ? moved_[k].response : from;
        const auto change = sight.apart(to, from);
        if (!change)
            continue;
        if (out.size() == 0)
            out.setZero(change->size(), open_.size());
        out.col(static_cast<Index>(k)) = std::sqrt(static_cast<double>(repeats)) / moved_[k].step * *change;
    }
    return out;
}

const Eigen::MatrixXd& Foretold::products(std::size_t is, std::size_t repeats) {
    const auto [at, fresh] = products_.try_emplace({is, repeats});
    if (!fresh)
        return at->second;
    const auto sight = sightOf(is, repeats);
    const Eigen::MatrixXd by = changes(*sight, repeats);
    std::vector<Eigen::VectorXd> from;
    Index rows = by.rows();
    for (std::size_t b = 0; b < rivals_.size(); ++b) {
        from.push_back(apart(*sight, repeats, is, b));
        rows = std::max(rows, from.back().size());
    }
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, open_.size() + static_cast<Index>(rivals_.size()));
    if (by.size() > 0)
        all.leftCols(open_.size()) = by;
    for (std::size_t b = 0; b < from.size(); ++b)
        if (from[b].size() > 0)
            all.col(open_.size() + static_cast<Index>(b)) = from[b];
    return at->second = all.transpose() * all;
}

} // namespace supercircle::diagnosis
