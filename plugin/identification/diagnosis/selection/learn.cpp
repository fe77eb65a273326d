#include "plugin/identification/diagnosis/selection/learn.h"

#include "plugin/identification/diagnosis/box.h"
#include "plugin/identification/diagnosis/result/words.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

Point withLaw(const Model& model, const Fitted& nominal, std::size_t candidate) {
    Point p = nominal.point;
    p.terms = {{candidate, std::vector<double>(model.candidates()[candidate].parameters.size(), 0.0), 1.0}};
    return p;
}

/// What the best coefficients would explain, by the linearised model.
double promise(const Variables& v, const Eigen::MatrixXd& J, const Fitted& nominal, const Eigen::VectorXd& x) {
    const Eigen::MatrixXd G = J.transpose() * J + v.penalty;
    const Eigen::VectorXd g = J.transpose() * nominal.residual - v.penalty * x;
    const Eigen::VectorXd step = boxMinimum(G, g, v.lower - x, v.upper - x);
    return 2.0 * g.dot(step) - step.dot(G * step);
}

/// S. N. Wood, M. Fasiolo (2017), eq. 3, with the scale known.
double smoothed(const Variables& v, const Fitted& f, double smoothing) {
    const Index n = v.size() - v.nominal;
    const Eigen::MatrixXd S = roughness(n, smoothing) - roughness(n, 0.0);
    Eigen::MatrixXd precision = f.jacobian.transpose() * f.jacobian + v.penalty;
    precision.topLeftCorner(v.nominal, v.nominal).diagonal().array() += 3.0; // of uniform intervals
    const Eigen::MatrixXd covariance = precision.ldlt().solve(Eigen::MatrixXd::Identity(v.size(), v.size()));
    const Eigen::VectorXd c = f.x.tail(n);
    const double freedom = static_cast<double>(n - 2) - (covariance.bottomRightCorner(n, n) * S).trace();
    return std::clamp(smoothing * std::max(0.05, freedom) / std::max(1e-6, c.dot(S * c)), 1e-2, 1e3);
}

} // namespace

std::vector<Tried> learn(Evaluator& evaluator, const Misfit& misfit, const Fitted& nominal, std::size_t most) {
    const Model& model = evaluator.model();
    struct Start {
        std::size_t candidate;
        Eigen::MatrixXd jacobian;
        double promise;
    };
    std::vector<Start> starts;
    for (std::size_t c = 0; c < model.candidates().size() && !evaluator.stopped(); ++c) {
        if (!model.candidates()[c].learned)
            continue;
        const Variables v(model, withLaw(model, nominal, c));
        Eigen::VectorXd x = Eigen::VectorXd::Zero(v.size());
        x.head(v.nominal) = nominal.x;
        Start s{c, Eigen::MatrixXd::Zero(misfit.rows(), v.size()), 0.0};
        s.jacobian.leftCols(v.nominal) = nominal.jacobian;
        std::vector<Index> own;
        for (Index k = v.nominal; k < v.size(); ++k)
            own.push_back(k);
        differentiate(evaluator, misfit, v, x, 0.5, own, s.jacobian);
        s.promise = promise(v, s.jacobian, nominal, x);
        starts.push_back(std::move(s));
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Start& a, const Start& b) { return a.promise > b.promise; });
    std::vector<Tried> all;
    for (const Start& s : starts) {
        if (all.size() >= most || s.promise < 12.0 || s.promise < 0.1 * starts.front().promise || evaluator.stopped())
            break;
        Tried t;
        t.candidates = {s.candidate};
        t.learned = true;
        t.fit = fit(evaluator, misfit, withLaw(model, nominal, s.candidate), {}, s.jacobian);
        if (!t.fit.failure.empty())
            continue;
        Point again = t.fit.point;
        again.terms.front().smoothing = smoothed(Variables(model, again), t.fit, again.terms.front().smoothing);
        FitSettings few;
        few.iterations = 6;
        few.refreshes = 1;
        Fitted better = fit(evaluator, misfit, again, few, t.fit.jacobian);
        if (better.failure.empty())
            t.fit = std::move(better);
        all.push_back(std::move(t));
    }
    return all;
}

LearnedLaw describe(const Model& model, const Misfit& misfit, const Tried& tried) {
    const Candidate& c = model.candidates()[tried.candidates.front()];
    const Curve& curve = c.curve;
    LearnedLaw law;
    law.label = c.label;
    law.slot = c.slot;
    law.law = c.law;
    law.of = curve.of;
    law.over = curve.over;
    law.overUnit = curve.unit;
    law.ofUnit = curve.relative ? "1" : curve.ofUnit;
    law.logarithmic = curve.logarithmic;
    const Variables v(model, tried.fit.point);
    const Index n = v.size() - v.nominal;
    const double spread = std::max(1.0, tried.fit.misfit / static_cast<double>(std::max<Index>(1, misfit.present())));
    Eigen::MatrixXd precision = tried.fit.jacobian.transpose() * tried.fit.jacobian / spread + v.penalty;
    precision.topLeftCorner(v.nominal, v.nominal).diagonal().array() += 3.0;
    const Eigen::MatrixXd posterior =
        precision.ldlt().solve(Eigen::MatrixXd::Identity(v.size(), v.size())).bottomRightCorner(n, n);
    const Eigen::MatrixXd prior = v.penalty.bottomRightCorner(n, n).ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    constexpr int kPoints = 41;
    std::vector<double> at;
    for (int i = 0; i < kPoints; ++i)
        at.push_back(static_cast<double>(i) / (kPoints - 1));
    Eigen::MatrixXd basis(kPoints, n); // the law is linear in its coefficients
    for (Index k = 0; k < n; ++k) {
        std::vector<double> one(static_cast<std::size_t>(n), 0.0);
        one[static_cast<std::size_t>(k)] = curve.scale * c.parameters[static_cast<std::size_t>(k)].step;
        const std::vector<double> column = curve.evaluate(one, at);
        basis.col(k) = Eigen::Map<const Eigen::VectorXd>(column.data(), kPoints);
    }
    const Eigen::VectorXd value = basis * tried.fit.x.tail(n);
    for (int i = 0; i < kPoints; ++i) {
        const Eigen::VectorXd b = basis.row(i);
        const double x = at[static_cast<std::size_t>(i)];
        law.at.push_back(curve.logarithmic ? curve.from * std::pow(curve.to / curve.from, x)
                                           : curve.from + x * (curve.to - curve.from));
        law.value.push_back(value[i]);
        law.deviation.push_back(std::sqrt(std::max(0.0, b.dot(posterior * b))));
        law.visited.push_back(law.deviation.back() < 0.5 * std::sqrt(std::max(1e-300, b.dot(prior * b))));
    }
    const auto first = std::find(law.visited.begin(), law.visited.end(), true);
    const auto last = std::find(law.visited.rbegin(), law.visited.rend(), true);
    if (first != law.visited.end()) {
        const auto a = static_cast<Index>(first - law.visited.begin());
        const Index b = kPoints - 1 - static_cast<Index>(last - law.visited.rbegin());
        const Eigen::VectorXd d = basis.row(b) - basis.row(a);
        law.change = value[b] - value[a];
        law.changeDeviation = std::sqrt(std::max(0.0, d.dot(posterior * d)));
    }
    law.words = inWords(law);
    return law;
}

} // namespace supercircle::diagnosis
