#include "plugin/identification/diagnosis/screening/screen.h"

#include "plugin/identification/diagnosis/box_qp.h"
#include "plugin/identification/diagnosis/localisation/localise.h"
#include "supercircle/support/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace supercircle::diagnosis {

namespace {

/// Amplitudes simulated between two others, and number of refinement rounds. A sharp threshold needs six rounds, a
/// resolution of 1e-4 (decision 0078).
constexpr int kBetween = 3, kRounds = 6;

bool bothSigns(const CandidateEffect& c) {
    return std::any_of(c.parameters.begin(), c.parameters.end(),
                       [](const Scalar& s) { return s.amplitude && s.lower < s.value; });
}

} // namespace

std::vector<double> scaledValues(const CandidateEffect& c, const std::vector<double>& values, double factor) {
    std::vector<double> out = values;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const Scalar& s = c.parameters[i];
        if (s.amplitude)
            out[i] = std::clamp(s.value + factor * (values[i] - s.value), s.lower, s.upper);
    }
    return out;
}

double explainTogether(const FitResult& fitted, const Variables& v,
                       const std::vector<const CandidateEffect*>& candidates,
                       const std::vector<const Eigen::VectorXd*>& signatures, std::vector<double>& factors) {
    const Eigen::Index n = v.size(), more = static_cast<Eigen::Index>(signatures.size());
    const Eigen::MatrixXd G = fitted.jacobian.transpose() * fitted.jacobian + v.penalty;
    const Eigen::VectorXd g = fitted.jacobian.transpose() * fitted.residual - v.penalty * fitted.x;
    Eigen::MatrixXd all(n + more, n + more);
    Eigen::VectorXd right(n + more), lower(n + more), upper(n + more);
    all.topLeftCorner(n, n) = G;
    right.head(n) = g;
    lower.head(n) = v.lower - fitted.x;
    upper.head(n) = v.upper - fitted.x;
    constexpr double kFar = 4.0; // largest scale factor of a probe
    for (Eigen::Index k = 0; k < more; ++k) {
        const Eigen::VectorXd& s = *signatures[static_cast<std::size_t>(k)];
        all.block(0, n + k, n, 1) = fitted.jacobian.transpose() * s;
        all.block(n + k, 0, 1, n) = all.block(0, n + k, n, 1).transpose();
        for (Eigen::Index l = 0; l <= k; ++l)
            all(n + k, n + l) = all(n + l, n + k) = s.dot(*signatures[static_cast<std::size_t>(l)]);
        right[n + k] = s.dot(fitted.residual);
        lower[n + k] = bothSigns(*candidates[static_cast<std::size_t>(k)]) ? -kFar : 0.0;
        upper[n + k] = kFar;
    }
    const Eigen::VectorXd x = solveBoxQp(all, right, lower, upper);
    const Eigen::VectorXd alone =
        solveBoxQp(G, g, v.lower - fitted.x, v.upper - fitted.x); // the fit may not be converged
    const double with = x.dot(all * x) - 2.0 * right.dot(x), without = alone.dot(G * alone) - 2.0 * g.dot(alone);
    factors.assign(x.begin() + n, x.end());
    return std::max(0.0, without - with);
}

void explain(const FitResult& fitted, const Variables& v, const CandidateEffect& candidate, ScreenedProbe& out) {
    std::vector<double> factor;
    out.gain = explainTogether(fitted, v, {&candidate}, {&out.signature}, factor);
    out.factor = factor.front();
    out.values = scaledValues(candidate, out.values, out.factor);
}

namespace {

/// Intermediate values by equal ratios, without the ends. Empty if the ends are equal.
std::vector<double> geometricBetween(double from, double to, int count) {
    std::vector<double> out;
    for (int i = 1; i <= count && from != to; ++i)
        out.push_back(from * math::pow(to / from, static_cast<double>(i) / (count + 1)));
    return out;
}

/// Decrease of |residual|^2 by a change of the simulation, with the fitted parameters adjusted.
double gainOf(const FitResult& fitted, const Variables& v, const Eigen::VectorXd& change) {
    const Eigen::MatrixXd G = fitted.jacobian.transpose() * fitted.jacobian + v.penalty;
    const auto least = [&](const Eigen::VectorXd& u) {
        const Eigen::VectorXd g = fitted.jacobian.transpose() * u - v.penalty * fitted.x;
        const Eigen::VectorXd d = solveBoxQp(G, g, v.lower - fitted.x, v.upper - fitted.x);
        return u.squaredNorm() + d.dot(G * d) - 2.0 * g.dot(d);
    };
    return least(fitted.residual) - least(fitted.residual - change);
}

} // namespace

std::vector<double> bestAmplitudeValues(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                                        const ScreenedProbe& probe) {
    if (probe.factor == 0.0)
        return probe.values;
    const CandidateEffect& candidate = evaluator.model().candidates()[probe.candidate];
    const std::vector<double>& probeValues = candidate.probes[probe.probe];
    const Variables v(evaluator.model(), fitted.point);
    std::map<double, double> gains; // by magnitude of the scale factor
    const auto simulate = [&](const std::vector<double>& magnitudes) {
        std::vector<ParameterPoint> points = {fitted.point};
        for (const double m : magnitudes) {
            points.push_back(fitted.point);
            points.back().terms.push_back(
                {probe.candidate, scaledValues(candidate, probeValues, std::copysign(m, probe.factor))});
        }
        const auto answers = evaluator.simulateAllRuns(points, Fidelity::Coarse);
        for (std::size_t i = 0; i < magnitudes.size(); ++i) {
            const auto change = likelihood.whitenedDifference(answers[i + 1], answers[0]);
            gains[magnitudes[i]] = change ? gainOf(fitted, v, *change) : -std::numeric_limits<double>::infinity();
        }
    };
    // The largest amplitude among equals: below a threshold all do nothing.
    const auto best = [&] {
        auto top = gains.begin();
        for (auto at = gains.begin(); at != gains.end(); ++at)
            top = at->second >= top->second - 1e-9 * std::abs(probe.gain) ? at : top;
        return top;
    };
    const double requested = std::abs(probe.factor);
    simulate({requested});
    if (best()->second >= 0.5 * probe.gain)
        return probe.values;
    simulate(geometricBetween(0.1 * requested, requested, kBetween));
    simulate(geometricBetween(requested, 1.0, kBetween));
    simulate({0.1 * requested, 1.0});
    const auto noGain = [&](const auto& at) { return std::abs(at->second) < 1e-3 * probe.gain; };
    for (int round = 0; round < kRounds && best()->second < 0.5 * probe.gain; ++round) {
        const auto at = best();
        if (!noGain(at) && (at == gains.begin() || !noGain(std::prev(at))))
            break; // there is no threshold
        const double here = at->first;
        const double below = at == gains.begin() ? here : std::prev(at)->first;
        const double above = std::next(at) == gains.end() ? here : std::next(at)->first;
        if (!noGain(at)) // no threshold below an amplitude without effect
            simulate(geometricBetween(below, here, kBetween));
        simulate(geometricBetween(here, above, kBetween));
    }
    return best()->second > 0.0 ? scaledValues(candidate, probeValues, std::copysign(best()->first, probe.factor))
                                : probe.values;
}

namespace {

/// Amplitude of a probe in relevant amplitudes (those of the first probe); 1 if not comparable.
double relativeAmplitudeOf(const CandidateEffect& c, std::size_t probe) {
    double times = 0.0;
    for (std::size_t i = 0; i < c.parameters.size(); ++i)
        if (const Scalar& s = c.parameters[i]; s.amplitude) {
            const double first = std::abs(c.probes.front()[i] - s.value),
                         probeValues = std::abs(c.probes[probe][i] - s.value);
            if (first > 0.0)
                times = std::max(times, probeValues / first);
        }
    return times > 0.0 ? times : 1.0;
}

/// A probe before it is simulated.
ScreenedProbe probeOf(const std::vector<CandidateEffect>& candidates, std::size_t candidate, std::size_t probe) {
    ScreenedProbe s;
    s.candidate = candidate;
    s.probe = probe;
    s.values = candidates[candidate].probes[probe];
    s.relativeAmplitude = relativeAmplitudeOf(candidates[candidate], probe);
    return s;
}

} // namespace

std::vector<ScreenedProbe> screen(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& nominal,
                                  double share) {
    const std::vector<CandidateEffect>& candidates = evaluator.model().candidates();
    std::vector<ParameterPoint> points = {nominal.point};
    std::vector<ScreenedProbe> all;
    // A number inside its interval explains nothing more outside. A fit to free runs may be out of phase.
    const auto tried = [&](const CandidateEffect& c) {
        return !c.isNumber() || likelihood.data().free || std::abs(nominal.x[c.number]) > kEndOfInterval;
    };
    for (std::size_t c = 0; c < candidates.size(); ++c)
        for (std::size_t p = 0; p < candidates[c].probes.size() && tried(candidates[c]); ++p) {
            all.push_back(probeOf(candidates, c, p));
            const ScreenedProbe& s = all.back();
            points.push_back(nominal.point);
            points.back().terms.push_back({c, share == 1.0 ? s.values : scaledValues(candidates[c], s.values, share)});
        }
    const auto answers = evaluator.simulateAllRuns(points, Fidelity::Coarse);
    const Variables v(evaluator.model(), nominal.point);
    const Eigen::MatrixXd Q = basisOf(nominal.jacobian);
    const auto see = [&](const std::vector<Response>& answer, double part, ScreenedProbe& s) {
        auto signature = likelihood.whitenedDifference(answer, answers[0]);
        if (!signature)
            return;
        *signature /= part;
        s.simulated = true;
        s.norm = signature->norm();
        s.independentNorm = (*signature - Q * (Q.transpose() * *signature)).norm();
        if (s.norm <= 1e-6)
            return;
        s.signature = *signature;
        explain(nominal, v, candidates[s.candidate], s);
    };
    for (std::size_t i = 0; i < all.size(); ++i)
        see(answers[i + 1], share, all[i]);
    if (!likelihood.data().free || share != 1.0)
        return all;
    // Tenths of what throws a swing out of phase, whose whole change says nothing of a smaller one.
    constexpr double kTenth = 0.1;
    constexpr int kTimes = 3;
    constexpr double kOutOfPhase = 5.0; // noise units of a reading; half of it simulates more probes twice
    const double limit = kOutOfPhase * std::sqrt(static_cast<double>(likelihood.countedRows()));
    std::vector<ScreenedProbe> large = all;
    double part = 1.0;
    for (int times = 0; times < kTimes; ++times) {
        std::erase_if(large, [&](const ScreenedProbe& s) { return !(s.norm * part > limit); });
        part *= kTenth;
        points.clear();
        for (ScreenedProbe& s : large) {
            s = probeOf(candidates, s.candidate, s.probe);
            points.push_back(nominal.point);
            points.back().terms.push_back({s.candidate, scaledValues(candidates[s.candidate], s.values, part)});
        }
        const auto nearer = evaluator.simulateAllRuns(points, Fidelity::Coarse);
        for (std::size_t i = 0; i < large.size(); ++i)
            see(nearer[i], part, large[i]);
        all.insert(all.end(), large.begin(), large.end());
    }
    return all;
}

} // namespace supercircle::diagnosis
