#include "plugin/identification/diagnosis/selection/fit_learned_laws.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/result/law_description.h"
#include "supercircle/support/dense.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

ParameterPoint withLaw(const Model& model, const FitResult& nominal, std::size_t candidate) {
    ParameterPoint p = nominal.point;
    p.terms = {{candidate, std::vector<double>(model.candidates()[candidate].parameters.size(), 0.0), 1.0}};
    return p;
}

/// Linearised decrease of the objective by the best coefficients.
double predictedGain(const Variables& v, const Eigen::MatrixXd& J, const FitResult& nominal, const Eigen::VectorXd& x) {
    const Eigen::MatrixXd G = J.transpose() * J + v.penalty;
    const Eigen::VectorXd g = J.transpose() * nominal.residual - v.penalty * x;
    const Eigen::VectorXd step = solveBoxQp(G, g, v.lower - x, v.upper - x);
    return 2.0 * g.dot(step) - step.dot(G * step);
}

/// Adds the inverse variances of uniform intervals; normal priors are part of the penalty.
void addIntervals(const Variables& v, Eigen::MatrixXd& precision) {
    for (Index i = 0; i < v.nominal; ++i)
        precision(i, i) += v.scalar(i).precision > 0.0 ? 0.0 : 3.0;
}

/// S. N. Wood, M. Fasiolo (2017), eq. 3, with the scale known.
double smoothed(const Variables& v, const FitResult& f, double smoothing) {
    const Index n = v.size() - v.nominal;
    const Eigen::MatrixXd S = smoothingPenalty(n, smoothing) - smoothingPenalty(n, 0.0);
    Eigen::MatrixXd precision = f.jacobian.transpose() * f.jacobian + v.penalty;
    addIntervals(v, precision);
    const Eigen::MatrixXd covariance = dense::inverseLdlt(precision);
    const Eigen::VectorXd c = f.x.tail(n);
    const double freedom = static_cast<double>(n - 2) - (covariance.bottomRightCorner(n, n) * S).trace();
    return std::clamp(smoothing * std::max(0.05, freedom) / std::max(1e-6, c.dot(S * c)), 1e-2, 1e3);
}

} // namespace

std::vector<FittedHypothesis> fitLearnedLaws(Evaluator& evaluator, const Likelihood& likelihood,
                                             const FitResult& nominal, std::size_t most) {
    const Model& model = evaluator.model();
    struct Start {
        std::size_t candidate;
        Eigen::MatrixXd jacobian;
        double predictedGain;
    };
    std::vector<Start> starts;
    for (std::size_t c = 0; c < model.candidates().size() && !evaluator.stopped(); ++c) {
        if (!model.candidates()[c].learned)
            continue;
        const Variables v(model, withLaw(model, nominal, c));
        Eigen::VectorXd x = Eigen::VectorXd::Zero(v.size());
        x.head(v.nominal) = nominal.x;
        Start s{c, Eigen::MatrixXd::Zero(likelihood.rows(), v.size()), 0.0};
        s.jacobian.leftCols(v.nominal) = nominal.jacobian;
        std::vector<Index> own;
        for (Index k = v.nominal; k < v.size(); ++k)
            own.push_back(k);
        differentiate(evaluator, likelihood, v, x, 0.5, own, s.jacobian);
        s.predictedGain = predictedGain(v, s.jacobian, nominal, x);
        starts.push_back(std::move(s));
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Start& a, const Start& b) { return a.predictedGain > b.predictedGain; });
    std::vector<FittedHypothesis> all;
    for (const Start& s : starts) {
        if (all.size() >= most || s.predictedGain < 12.0 || s.predictedGain < 0.1 * starts.front().predictedGain ||
            evaluator.stopped())
            break;
        FittedHypothesis t;
        t.candidates = {s.candidate};
        t.learned = true;
        t.fit = fit(evaluator, likelihood, withLaw(model, nominal, s.candidate), {}, s.jacobian);
        if (!t.fit.failure.empty())
            continue;
        ParameterPoint again = t.fit.point;
        again.terms.front().smoothing = smoothed(Variables(model, again), t.fit, again.terms.front().smoothing);
        FitSettings few;
        few.iterations = 6;
        few.refreshes = 1;
        FitResult better = fit(evaluator, likelihood, again, few, t.fit.jacobian);
        if (better.failure.empty())
            t.fit = std::move(better);
        all.push_back(std::move(t));
    }
    return all;
}

LearnedLaw learnedLawOf(const Model& model, const Likelihood& likelihood, const FittedHypothesis& hypotheses) {
    const CandidateEffect& c = model.candidates()[hypotheses.candidates.front()];
    const LearnedCurve& curve = c.curve;
    LearnedLaw law;
    law.label = c.label;
    law.slot = c.slot;
    law.law = c.law;
    law.response = curve.response;
    law.state = curve.state;
    law.stateUnit = curve.stateUnit;
    law.responseUnit = curve.relative ? "1" : curve.responseUnit;
    law.logarithmic = curve.logarithmic;
    const Variables v(model, hypotheses.fit.point);
    const Index n = v.size() - v.nominal;
    const double spread =
        std::max(1.0, hypotheses.fit.chiSquared / static_cast<double>(std::max<Index>(1, likelihood.countedRows())));
    Eigen::MatrixXd precision = hypotheses.fit.jacobian.transpose() * hypotheses.fit.jacobian / spread + v.penalty;
    addIntervals(v, precision);
    const Eigen::MatrixXd posterior = dense::inverseLdlt(precision).bottomRightCorner(n, n);
    const Eigen::MatrixXd prior = dense::inverseLdlt(v.penalty.bottomRightCorner(n, n));
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
    const Eigen::VectorXd value = basis * hypotheses.fit.x.tail(n);
    for (int i = 0; i < kPoints; ++i) {
        const Eigen::VectorXd b = basis.row(i);
        const double x = at[static_cast<std::size_t>(i)];
        law.states.push_back(curve.logarithmic ? curve.from * math::pow(curve.to / curve.from, x)
                                               : curve.from + x * (curve.to - curve.from));
        law.value.push_back(value[i]);
        law.sigma.push_back(std::sqrt(std::max(0.0, b.dot(posterior * b))));
        law.inStateRange.push_back(law.sigma.back() < 0.5 * std::sqrt(std::max(1e-300, b.dot(prior * b))));
    }
    const auto first = std::find(law.inStateRange.begin(), law.inStateRange.end(), true);
    const auto last = std::find(law.inStateRange.rbegin(), law.inStateRange.rend(), true);
    if (first != law.inStateRange.end()) {
        const auto a = static_cast<Index>(first - law.inStateRange.begin());
        const Index b = kPoints - 1 - static_cast<Index>(last - law.inStateRange.rbegin());
        const Eigen::VectorXd d = basis.row(b) - basis.row(a);
        law.change = value[b] - value[a];
        law.changeSigma = std::sqrt(std::max(0.0, d.dot(posterior * d)));
    }
    law.description = describeLaw(law);
    return law;
}

} // namespace supercircle::diagnosis
