#include "plugin/diagnosis/screen.h"

#include "plugin/diagnosis/box.h"
#include "plugin/diagnosis/localise.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

bool bothSigns(const Candidate& c) {
    return std::any_of(c.parameters.begin(), c.parameters.end(),
                       [](const Scalar& s) { return s.amplitude && s.lower < s.value; });
}

} // namespace

std::vector<double> stretched(const Candidate& c, const std::vector<double>& values, double factor) {
    std::vector<double> out = values;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const Scalar& s = c.parameters[i];
        if (s.amplitude)
            out[i] = std::clamp(s.value + factor * (values[i] - s.value), s.lower, s.upper);
    }
    return out;
}

/// Best stretch of a signature beside what is fitted already, and the gain.
void explain(const Fitted& fitted, const Variables& v, const Candidate& candidate, Screened& out) {
    const Eigen::VectorXd& s = out.signature;
    const Eigen::Index n = v.size();
    const Eigen::MatrixXd G = fitted.jacobian.transpose() * fitted.jacobian;
    const Eigen::VectorXd g = fitted.jacobian.transpose() * fitted.residual;
    Eigen::MatrixXd all(n + 1, n + 1);
    all.topLeftCorner(n, n) = G;
    all.topRightCorner(n, 1) = fitted.jacobian.transpose() * s;
    all.bottomLeftCorner(1, n) = all.topRightCorner(n, 1).transpose();
    all(n, n) = s.squaredNorm();
    Eigen::VectorXd right(n + 1), lower(n + 1), upper(n + 1);
    right << g, s.dot(fitted.residual);
    constexpr double kFar = 4.0; // a signature is not believed farther than this many probes
    lower << v.lower - fitted.x, (bothSigns(candidate) ? -kFar : 0.0);
    upper << v.upper - fitted.x, kFar;
    const Eigen::VectorXd x = boxMinimum(all, right, lower, upper);
    const Eigen::VectorXd alone =
        boxMinimum(G, g, v.lower - fitted.x, v.upper - fitted.x); // the fit need not be perfect
    const double with = x.dot(all * x) - 2.0 * right.dot(x), without = alone.dot(G * alone) - 2.0 * g.dot(alone);
    out.stretch = x[n];
    out.gain = std::max(0.0, without - with);
    out.values = stretched(candidate, out.values, out.stretch);
}

std::vector<Screened> screen(Evaluator& evaluator, const Misfit& misfit, const Fitted& nominal, double share) {
    const std::vector<Candidate>& candidates = evaluator.model().candidates();
    std::vector<Point> points = {nominal.point};
    std::vector<Screened> all;
    for (std::size_t c = 0; c < candidates.size(); ++c)
        for (std::size_t p = 0; p < candidates[c].probes.size(); ++p) {
            Screened s;
            s.candidate = c;
            s.probe = p;
            s.values = candidates[c].probes[p];
            all.push_back(s);
            points.push_back(nominal.point);
            points.back().terms.push_back({c, share == 1.0 ? s.values : stretched(candidates[c], s.values, share)});
        }
    const auto answers = evaluator.everywhere(points, Fineness::Coarse);
    const Variables v(evaluator.model(), nominal.point);
    const Eigen::MatrixXd Q = basisOf(nominal.jacobian);
    for (std::size_t i = 0; i < all.size(); ++i) {
        auto signature = misfit.difference(answers[i + 1], answers[0]);
        if (!signature)
            continue;
        *signature /= share;
        Screened& s = all[i];
        s.simulated = true;
        s.size = signature->norm();
        s.own = (*signature - Q * (Q.transpose() * *signature)).norm();
        if (s.size <= 1e-6)
            continue;
        s.signature = *signature;
        explain(nominal, v, candidates[s.candidate], s);
    }
    return all;
}

} // namespace supercircle::diagnosis
