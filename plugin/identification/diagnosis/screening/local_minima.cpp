#include "plugin/identification/diagnosis/screening/local_minima.h"

#include "plugin/identification/diagnosis/estimation/profile.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr double kElsewhere = 0.1; ///< of the arc, smallest distance of two positions
constexpr std::size_t kProbes = 2; ///< probes fitted beside the mirror image

/// Index of the position among a candidate's values; -1: it has none.
Index positionOf(const CandidateEffect& c) {
    const auto at = std::find_if(c.parameters.begin(), c.parameters.end(), [](const Scalar& s) { return s.position; });
    return at == c.parameters.end() ? -1 : static_cast<Index>(at - c.parameters.begin());
}

double valueAt(const std::vector<double>& values, Index i) {
    return values[static_cast<std::size_t>(i)];
}

bool apart(double a, double b) {
    return std::abs(a - b) > kElsewhere;
}

/// Starts: the best probes at other positions and the mirror image.
std::vector<std::vector<double>> otherPositions(const Term& present, Index position,
                                                const std::vector<ScreenedProbe>& screened) {
    const auto elsewhere = [&](const std::vector<double>& a, const std::vector<double>& b) {
        return apart(valueAt(a, position), valueAt(b, position));
    };
    std::vector<const ScreenedProbe*> probes;
    for (const ScreenedProbe& s : screened)
        if (s.candidate == present.candidate && s.simulated && s.gain > 0.0 && elsewhere(s.values, present.values))
            probes.push_back(&s);
    std::stable_sort(probes.begin(), probes.end(),
                     [](const ScreenedProbe* a, const ScreenedProbe* b) { return a->gain > b->gain; });
    std::vector<std::vector<double>> starts;
    for (const ScreenedProbe* s : probes)
        if (starts.size() < kProbes &&
            std::all_of(starts.begin(), starts.end(), [&](const auto& o) { return elsewhere(o, s->values); }))
            starts.push_back(s->values);
    // A probe at the mirrored position has another sign or angle, so it is another start.
    starts.push_back(present.values);
    starts.back()[static_cast<std::size_t>(position)] = 1.0 - valueAt(present.values, position);
    if (!elsewhere(starts.back(), present.values))
        starts.pop_back();
    return starts;
}

/// Whether an amplitude may have either sign.
bool hasEitherSign(const Scalar& s) {
    return s.amplitude && s.scale != Scale::Logarithm && s.lower < 0.0 && s.upper > 0.0;
}

/// Starts with the sign of one amplitude changed, where that explains anything.
std::vector<std::vector<double>> oppositeSigns(Evaluator& evaluator, const Likelihood& likelihood,
                                               const FitResult& fitted, double without) {
    const Term& present = fitted.point.terms.front();
    const CandidateEffect& c = evaluator.model().candidates()[present.candidate];
    std::vector<std::vector<double>> starts;
    for (std::size_t i = 0; i < c.parameters.size() && !evaluator.stopped(); ++i) {
        if (!hasEitherSign(c.parameters[i]) || present.values[i] == 0.0)
            continue;
        std::vector<double> values = present.values;
        values[i] = std::clamp(-values[i], c.parameters[i].lower, c.parameters[i].upper);
        ParameterPoint point = fitted.point;
        point.terms.front().values = values;
        const auto there = evaluator.simulateAllRuns({point}, Fidelity::Fine).front();
        const auto residual = likelihood.residual(there);
        if (residual && residual->squaredNorm() + likelihood.maskPenalty(there).sum() < without)
            starts.push_back(std::move(values));
    }
    return starts;
}

} // namespace

std::vector<FitResult> otherLocalMinima(Evaluator& evaluator, const Likelihood& likelihood, const FitResult& fitted,
                                        const std::vector<ScreenedProbe>& screened, double without) {
    std::vector<FitResult> found;
    if (fitted.point.terms.size() != 1)
        return found;
    const Term& present = fitted.point.terms.front();
    const CandidateEffect& c = evaluator.model().candidates()[present.candidate];
    const Index position = positionOf(c);
    const auto elsewhere = [&](const std::vector<double>& values) {
        bool other = position >= 0 && apart(valueAt(values, position), valueAt(present.values, position));
        for (std::size_t i = 0; i < values.size() && position < 0; ++i)
            other = other || (hasEitherSign(c.parameters[i]) && values[i] * present.values[i] < 0.0);
        return other;
    };
    FitSettings settings;
    settings.competitor = fitted.chiSquared;
    for (const std::vector<double>& start : position >= 0 ? otherPositions(present, position, screened)
                                                          : oppositeSigns(evaluator, likelihood, fitted, without)) {
        if (evaluator.stopped())
            break;
        FitResult f = fit(evaluator, likelihood,
                          ParameterPoint{fitted.point.nominal, {{present.candidate, start, present.smoothing}}},
                          settings, fitted.jacobian.leftCols(static_cast<Index>(fitted.point.nominal.size())));
        if (f.failure.empty() && elsewhere(f.point.terms.front().values))
            found.push_back(std::move(f));
    }
    return found;
}

const FitResult* widenByLocalMinima(const std::vector<FitResult>& minima, const Model& model, const FitResult& fitted,
                                    const Eigen::VectorXd& dispersions, std::vector<Interval>& intervals) {
    const Variables v(model, fitted.point);
    const bool hasPosition =
        fitted.point.terms.size() != 1 || positionOf(model.candidates()[fitted.point.terms.front().candidate]) >= 0;
    const std::vector<Interval> alone = intervals;
    const FitResult* image = nullptr;
    for (const FitResult& h : minima) {
        const std::vector<Interval> there = linearIntervals(v, h, h.jacobian, dispersions);
        for (Index k = v.nominal; k < v.size(); ++k) {
            const double left = 1.0 - (h.chiSquared - fitted.chiSquared) /
                                          (k90 * k90 * dispersions[k]); // remaining height up to the level
            if (left <= 0.0)
                continue;
            const auto i = static_cast<std::size_t>(k - v.nominal);
            const double reach = std::min(1.0, std::sqrt(left));
            const double low = h.x[k] + reach * (there[i].low - h.x[k]),
                         high = h.x[k] + reach * (there[i].high - h.x[k]);
            // An amplitude compatible with 0 has no sign.
            if (!hasPosition && hasEitherSign(v.scalar(k)) && alone[i].low * alone[i].high > 0.0 && low * high > 0.0 &&
                low * alone[i].low < 0.0) {
                const double least =
                    std::min({std::abs(low), std::abs(high), std::abs(alone[i].low), std::abs(alone[i].high)});
                intervals[i].smallestMagnitude =
                    intervals[i].signAmbiguous ? std::min(intervals[i].smallestMagnitude, least) : least;
                intervals[i].signAmbiguous = true;
                image = image == nullptr || h.chiSquared < image->chiSquared ? &h : image;
            }
            intervals[i].low = std::min(intervals[i].low, low);
            intervals[i].high = std::max(intervals[i].high, high);
        }
    }
    return image;
}

} // namespace supercircle::diagnosis
