#include "plugin/identification/diagnosis/visibility.h"

#include "plugin/identification/diagnosis/likelihood.h"
#include "supercircle/support/dense.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace supercircle::diagnosis {

namespace {

using Eigen::Index;

/// Change, in standard deviations, that is found with 80 % power: 3.2 at the family-wise level of some 50 windows, and
/// 0.84. It decides what `check` says, and no verdict. Half names effects that three of four diagnoses miss; double
/// leaves out effects that all find.
constexpr double kSeen = 4.0;
/// Share of a change that makes a number its likeness.
constexpr double kLike = 0.5;

/// Whitened change of all readings; zero where one of the points cannot be simulated.
Eigen::VectorXd changeOf(const Likelihood& likelihood, const std::vector<Response>& there,
                         const std::vector<Response>& base) {
    const auto d = likelihood.whitenedDifference(there, base);
    return d ? *d : Eigen::VectorXd::Zero(likelihood.rows());
}

/// The stated numbers with each effect of the catalogue at a noticeable size: every effect once, then other laws of it.
std::vector<ParameterPoint> probesOf(const Model& model, const ParameterPoint& stated) {
    std::vector<ParameterPoint> probes, others;
    std::set<std::string> labels;
    for (std::size_t c = 0; c < model.candidates().size(); ++c) {
        const CandidateEffect& candidate = model.candidates()[c];
        if (candidate.learned || candidate.probes.empty())
            continue;
        std::vector<ParameterPoint>& list = labels.insert(candidate.label).second ? probes : others;
        list.push_back(stated);
        list.back().terms.push_back({c, candidate.probes.front()});
    }
    probes.insert(probes.end(), others.begin(), others.end());
    return probes;
}

/// All runs at each point, none where it was interrupted. One after another: `next` is asked before each.
std::vector<std::vector<Response>> simulateEach(Evaluator& evaluator, const std::vector<ParameterPoint>& points,
                                                const std::function<bool()>& next) {
    std::vector<std::vector<Response>> all(points.size());
    for (std::size_t p = 0; p < points.size() && (!next || next()); ++p)
        try {
            all[p] = std::move(evaluator.simulateAllRuns({points[p]}, Fidelity::Coarse).front());
        } catch (const Stopped&) {
            if (!next)
                break;
        }
    return all;
}

} // namespace

bool VisibleNumber::seen() const {
    return left < 0.5 * known;
}

bool VisibleEffect::seen() const {
    return own >= kSeen;
}

bool VisibleEffect::imitated() const {
    return !seen() && change >= kSeen;
}

Visibility visibilityOf(const RecordedData& data, const Noise& noise, Evaluator& evaluator,
                        const std::function<bool()>& next) {
    Visibility out;
    const Model& model = evaluator.model();
    const std::vector<Scalar>& nominal = model.nominal();
    const ParameterPoint stated = statedPoint(model);
    // Half of a half-width: nonlinear where phases turn, so that free runs take a twentieth.
    const double share = data.free ? 0.05 : 0.5;
    std::vector<ParameterPoint> points = {stated};
    std::vector<double> steps; // in half-widths
    for (std::size_t i = 0; i < nominal.size(); ++i) {
        const Scalar& s = nominal[i];
        steps.push_back(s.value + share * s.step <= s.upper ? share : -share);
        points.push_back(stated);
        points.back().nominal[i] += steps.back() * s.step;
    }
    const std::vector<std::vector<Response>> all = evaluator.simulateAllRuns(points, Fidelity::Coarse);
    const std::vector<Response>& base = all.front();
    for (std::size_t r = 0; r < base.size(); ++r)
        if (!base[r].failure.empty()) {
            out.failure = data.runs[r].name + ": " + base[r].failure;
            return out;
        }
    const Likelihood likelihood(data, noise, base, base, LikelihoodSettings{}.in(data.units));
    const auto count = static_cast<Index>(nominal.size());
    Eigen::MatrixXd jacobian(likelihood.rows(), count);
    for (Index i = 0; i < count; ++i)
        jacobian.col(i) =
            changeOf(likelihood, all[static_cast<std::size_t>(i) + 1], base) / steps[static_cast<std::size_t>(i)];
    constexpr double kPrior = 3.0; // inverse variance of an interval, in half-widths
    Eigen::MatrixXd precision = jacobian.transpose() * jacobian;
    for (Index i = 0; i < count; ++i) {
        const double own = nominal[static_cast<std::size_t>(i)].precision;
        precision(i, i) += own > 0.0 ? own : kPrior;
    }
    const Eigen::MatrixXd covariance = dense::inverseLdlt(precision);
    for (Index i = 0; i < count; ++i) {
        const Scalar& s = nominal[static_cast<std::size_t>(i)];
        const double unit = s.scale == Scale::Logarithm ? toPhysical(s.scale, s.value) * s.step : s.step;
        const double known = unit / std::sqrt(s.precision > 0.0 ? s.precision : kPrior);
        out.numbers.push_back({s.name, s.unit, unit, known, unit * std::sqrt(covariance(i, i))});
    }
    const std::vector<ParameterPoint> probes = probesOf(model, stated);
    const std::vector<std::vector<Response>> probed = simulateEach(evaluator, probes, next);
    for (std::size_t p = 0; p < probes.size(); ++p) {
        const std::string& label = model.candidates()[probes[p].terms.front().candidate].label;
        if (probed[p].empty()) {
            if (std::find(out.untried.begin(), out.untried.end(), label) == out.untried.end())
                out.untried.push_back(label);
            continue;
        }
        const Eigen::VectorXd change = changeOf(likelihood, probed[p], base);
        const Eigen::VectorXd shared = jacobian.transpose() * change;
        VisibleEffect e;
        e.label = label;
        e.change = change.norm();
        e.own = std::sqrt(std::max(0.0, change.squaredNorm() - shared.dot(covariance * shared)));
        double most = kLike * change.squaredNorm();
        for (Index i = 0; i < count; ++i)
            if (const double n = jacobian.col(i).squaredNorm(); n > 0.0 && shared[i] * shared[i] / n > most) {
                most = shared[i] * shared[i] / n;
                e.like = nominal[static_cast<std::size_t>(i)].name;
            }
        const auto known = std::find_if(out.effects.begin(), out.effects.end(),
                                        [&](const VisibleEffect& other) { return other.label == e.label; });
        if (known == out.effects.end())
            out.effects.push_back(std::move(e));
        else if (e.own > known->own)
            *known = std::move(e);
    }
    std::erase_if(out.untried, [&](const std::string& label) { // another law of it was tried
        return std::any_of(out.effects.begin(), out.effects.end(),
                           [&](const VisibleEffect& e) { return e.label == label; });
    });
    std::stable_sort(out.effects.begin(), out.effects.end(),
                     [](const VisibleEffect& a, const VisibleEffect& b) { return a.own > b.own; });
    return out;
}

} // namespace supercircle::diagnosis
