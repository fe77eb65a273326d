#include "plugin/identification/calibration/curve.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/simulation_cache.h"
#include "supercircle/step/parallel.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace supercircle::calibration {

namespace {

using diagnosis::Evaluator;
using diagnosis::Fidelity;
using diagnosis::FitResult;
using diagnosis::Likelihood;
using diagnosis::ParameterPoint;
using Eigen::Index;

constexpr double kRise = 2.7055; ///< of chi-squared at the ends of a 90 % interval, one degree of freedom

/// The description with uncertain friction, so that it is fitted.
experiment::Experiment withUncertainFriction(experiment::Experiment e) {
    e.friction.halfWidth = std::max(e.friction.halfWidth, 0.05);
    return e;
}

/// A replay with a friction coefficient in [0, largest].
class UncertainFriction final : public diagnosis::Model {
public:
    UncertainFriction(const experiment::Experiment& e, double largest) : replay_(e), nominal_(replay_.nominal()) {
        for (std::size_t i = 0; i < nominal_.size(); ++i)
            if (nominal_[i].name == "friction") {
                friction = static_cast<Index>(i);
                nominal_[i].lower = 0.0;
                nominal_[i].upper = largest;
                nominal_[i].step = 0.05;
            }
    }
    [[nodiscard]] const std::vector<diagnosis::Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<diagnosis::CandidateEffect>& candidates() const override {
        return replay_.candidates();
    }
    [[nodiscard]] diagnosis::Response simulate(std::size_t run, const ParameterPoint& point, Fidelity fidelity,
                                               const std::atomic<bool>* interrupt) const override {
        return replay_.simulate(run, point, fidelity, interrupt);
    }
    [[nodiscard]] std::string identity() const override { return "uncertain friction " + replay_.identity(); }

    Index friction = -1; ///< its index in nominal()

private:
    diagnosis::ReplayModel replay_;
    std::vector<diagnosis::Scalar> nominal_;
};

/// Smallest chi-squared of the linearised fit with variable `fixed` at `value` and all others inside their bounds.
double profile(const FitResult& fit, const diagnosis::Variables& v, Index fixed, double value) {
    const Index n = v.size();
    Eigen::MatrixXd others(fit.jacobian.rows(), n - 1);
    Eigen::VectorXd lower(n - 1), upper(n - 1);
    for (Index i = 0, k = 0; i < n; ++i)
        if (i != fixed) {
            others.col(k) = fit.jacobian.col(i);
            lower[k] = v.lower[i] - fit.x[i];
            upper[k] = v.upper[i] - fit.x[i];
            ++k;
        }
    const Eigen::VectorXd residual = fit.residual - fit.jacobian.col(fixed) * (value - fit.x[fixed]);
    const Eigen::VectorXd step =
        diagnosis::solveBoxQp(others.transpose() * others, others.transpose() * residual, lower, upper);
    return (residual - others * step).squaredNorm();
}

/// Where chi-squared has risen by `rise` in direction `sign`; at most the variable's bound.
double reach(const FitResult& fit, const diagnosis::Variables& v, Index at, double sign, double rise) {
    const double bound = sign > 0.0 ? v.upper[at] : v.lower[at];
    const double best = profile(fit, v, at, fit.x[at]);
    double inside = fit.x[at], outside = fit.x[at];
    for (double step = 1e-3; profile(fit, v, at, outside) - best < rise; step *= 2.0) {
        inside = outside;
        if (outside == bound)
            return bound;
        outside = sign > 0.0 ? std::min(fit.x[at] + step, bound) : std::max(fit.x[at] - step, bound);
    }
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (inside + outside);
        (profile(fit, v, at, middle) - best < rise ? inside : outside) = middle;
    }
    return outside;
}

} // namespace

CurveResult frictionFromCurve(const experiment::Experiment& stated, const CurveSettings& settings) {
    const experiment::Experiment e = withUncertainFriction(stated);
    const UncertainFriction model(e, settings.largest);
    CurveResult out;
    const diagnosis::RecordedData data = diagnosis::recordedDataOf(e);
    const diagnosis::Noise noise = diagnosis::estimateNoise(data);
    out.noise = noise.total();
    diagnosis::SimulationCache cache;
    Evaluator evaluator(model, e.runs.size(), step::threadLoop(settings.jobs), cache, settings.interrupt);
    std::size_t done = 0;
    evaluator.onRun = [&] {
        ++done;
        if (settings.progress) // about sixty simulations a run, more after a poor start
            settings.progress(
                1.0 - 1.0 / (1.0 + static_cast<double>(done) / (40.0 * static_cast<double>(e.runs.size()))), "fitting");
    };
    ParameterPoint at = diagnosis::statedPoint(model);
    FitResult fit;
    std::unique_ptr<Likelihood> likelihood;
    for (int round = 0; round < 2; ++round) { // the second round uses the model error near the fit
        const auto fine = evaluator.simulateAllRuns({at}, Fidelity::Fine).front();
        const auto finer = evaluator.simulateAllRuns({at}, Fidelity::Finer).front();
        likelihood = std::make_unique<Likelihood>(data, noise, fine, finer);
        fit = diagnosis::fit(evaluator, *likelihood, at);
        out.stopped = evaluator.stopped();
        out.failure = out.stopped ? "" : fit.failure;
        if (out.stopped || !out.failure.empty())
            return out;
        at = fit.point;
    }
    const diagnosis::Variables v(model, at);
    out.chiSquaredPerReading = fit.chiSquared / std::max(1.0, static_cast<double>(likelihood->countedRows()));
    const double rise = kRise * std::max(1.0, out.chiSquaredPerReading);
    const auto value = [&](double x) { return v.scalar(model.friction).value + x * v.scalar(model.friction).step; };
    out.friction = value(fit.x[model.friction]);
    out.low = value(reach(fit, v, model.friction, -1.0, rise));
    out.high = value(reach(fit, v, model.friction, 1.0, rise));
    for (Index i = 0; i < v.size(); ++i)
        if (i != model.friction)
            out.others.emplace_back(
                v.scalar(i).name,
                diagnosis::toPhysical(v.scalar(i).scale, fit.point.nominal[static_cast<std::size_t>(i)]));
    out.simulations = evaluator.distinctRequests();
    return out;
}

} // namespace supercircle::calibration
