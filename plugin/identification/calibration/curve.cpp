#include "plugin/identification/calibration/curve.h"

#include "plugin/identification/diagnosis/box.h"
#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/misfit.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/store.h"
#include "supercircle/step/parallel.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace supercircle::calibration {

namespace {

using diagnosis::Evaluator;
using diagnosis::Fineness;
using diagnosis::Fitted;
using diagnosis::Misfit;
using diagnosis::Point;
using Eigen::Index;

constexpr double kRise = 2.7055; ///< of the misfit at the ends of a 90 % interval, one degree of freedom

/// The description with friction uncertain: else it would not be among what is fitted.
experiment::Experiment withOpenFriction(experiment::Experiment e) {
    e.friction.halfWidth = std::max(e.friction.halfWidth, 0.05);
    return e;
}

/// A replay whose friction coefficient may be anything.
class OpenFriction final : public diagnosis::Model {
public:
    OpenFriction(const experiment::Experiment& e, double most) : inner_(e), nominal_(inner_.nominal()) {
        for (std::size_t i = 0; i < nominal_.size(); ++i)
            if (nominal_[i].name == "friction") {
                friction = static_cast<Index>(i);
                nominal_[i].lower = 0.0;
                nominal_[i].upper = most;
                nominal_[i].step = 0.05;
            }
    }
    [[nodiscard]] const std::vector<diagnosis::Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<diagnosis::Candidate>& candidates() const override { return inner_.candidates(); }
    [[nodiscard]] diagnosis::Response simulate(std::size_t run, const Point& point, Fineness fineness,
                                               const std::atomic<bool>* interrupt) const override {
        return inner_.simulate(run, point, fineness, interrupt);
    }
    [[nodiscard]] std::string identity() const override { return "open friction " + inner_.identity(); }

    Index friction = -1; ///< which of nominal() it is

private:
    diagnosis::ReplayModel inner_;
    std::vector<diagnosis::Scalar> nominal_;
};

/// Least misfit of the linearised fit with variable `fixed` at `value` and all others inside their box.
double profile(const Fitted& fit, const diagnosis::Variables& v, Index fixed, double value) {
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
        diagnosis::boxMinimum(others.transpose() * others, others.transpose() * residual, lower, upper);
    return (residual - others * step).squaredNorm();
}

/// How far from the fit, in direction `sign`, the misfit has risen by `rise`; at most to the variable's bound.
double reach(const Fitted& fit, const diagnosis::Variables& v, Index at, double sign, double rise) {
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
    const experiment::Experiment e = withOpenFriction(stated);
    const OpenFriction model(e, settings.most);
    CurveResult out;
    const diagnosis::Data data = diagnosis::dataOf(e);
    const diagnosis::Noise noise = diagnosis::estimateNoise(data);
    out.noise = noise.total();
    diagnosis::Store memory;
    Evaluator evaluator(model, e.runs.size(), step::threadLoop(settings.jobs), memory, settings.interrupt);
    std::size_t done = 0;
    evaluator.onRun = [&] {
        ++done;
        if (settings.progress) // some sixty simulations a run, more where the first guess is far
            settings.progress(
                1.0 - 1.0 / (1.0 + static_cast<double>(done) / (40.0 * static_cast<double>(e.runs.size()))), "fitting");
    };
    Point at;
    for (const diagnosis::Scalar& s : model.nominal())
        at.nominal.push_back(s.value);
    Fitted fit;
    std::unique_ptr<Misfit> misfit;
    for (int round = 0; round < 2; ++round) { // the second weighs rows by what the simulation is like where it fits
        const auto fine = evaluator.everywhere({at}, Fineness::Fine).front();
        const auto finer = evaluator.everywhere({at}, Fineness::Finer).front();
        misfit = std::make_unique<Misfit>(data, noise, fine, finer);
        fit = diagnosis::fit(evaluator, *misfit, at);
        out.stopped = evaluator.stopped();
        out.failure = out.stopped ? "" : fit.failure;
        if (out.stopped || !out.failure.empty())
            return out;
        at = fit.point;
    }
    const diagnosis::Variables v(model, at);
    out.misfitPerRow = fit.misfit / std::max(1.0, static_cast<double>(misfit->present()));
    const double rise = kRise * std::max(1.0, out.misfitPerRow);
    const auto value = [&](double x) { return v.scalar(model.friction).value + x * v.scalar(model.friction).step; };
    out.friction = value(fit.x[model.friction]);
    out.low = value(reach(fit, v, model.friction, -1.0, rise));
    out.high = value(reach(fit, v, model.friction, 1.0, rise));
    for (Index i = 0; i < v.size(); ++i)
        if (i != model.friction)
            out.others.emplace_back(v.scalar(i).name, fit.point.nominal[static_cast<std::size_t>(i)]);
    out.simulations = evaluator.asked();
    return out;
}

} // namespace supercircle::calibration
