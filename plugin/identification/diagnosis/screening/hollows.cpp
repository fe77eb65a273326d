#include "plugin/identification/diagnosis/screening/hollows.h"

#include "plugin/identification/diagnosis/estimation/profile.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

constexpr double kElsewhere = 0.1; ///< of the arc: places that are no neighbours
constexpr std::size_t kProbes = 2; ///< that are worth a fit beside the mirror image

/// Of the values of a candidate; -1: it has no place.
Index placeOf(const Candidate& c) {
    const auto at = std::find_if(c.parameters.begin(), c.parameters.end(), [](const Scalar& s) { return s.place; });
    return at == c.parameters.end() ? -1 : static_cast<Index>(at - c.parameters.begin());
}

double valueAt(const std::vector<double>& values, Index i) {
    return values[static_cast<std::size_t>(i)];
}

bool apart(double a, double b) {
    return std::abs(a - b) > kElsewhere;
}

/// The best probes elsewhere along the arc, and the mirror image.
std::vector<std::vector<double>> otherPlaces(const Term& is, Index place, const std::vector<Screened>& screened) {
    const auto elsewhere = [&](const std::vector<double>& a, const std::vector<double>& b) {
        return apart(valueAt(a, place), valueAt(b, place));
    };
    std::vector<const Screened*> probes;
    for (const Screened& s : screened)
        if (s.candidate == is.candidate && s.simulated && s.gain > 0.0 && elsewhere(s.values, is.values))
            probes.push_back(&s);
    std::stable_sort(probes.begin(), probes.end(),
                     [](const Screened* a, const Screened* b) { return a->gain > b->gain; });
    std::vector<std::vector<double>> starts;
    for (const Screened* s : probes)
        if (starts.size() < kProbes &&
            std::all_of(starts.begin(), starts.end(), [&](const auto& o) { return elsewhere(o, s->values); }))
            starts.push_back(s->values);
    // A probe in the place of the mirror image bends to another side or by another angle: another start.
    starts.push_back(is.values);
    starts.back()[static_cast<std::size_t>(place)] = 1.0 - valueAt(is.values, place);
    if (!elsewhere(starts.back(), is.values))
        starts.pop_back();
    return starts;
}

/// Whether an amplitude may have either sign.
bool sided(const Scalar& s) {
    return s.amplitude && s.lower < 0.0 && s.upper > 0.0;
}

/// The same with the sign of one amplitude changed, where that explains anything.
std::vector<std::vector<double>> otherSides(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                                            double without) {
    const Term& is = fitted.point.terms.front();
    const Candidate& c = evaluator.model().candidates()[is.candidate];
    std::vector<std::vector<double>> starts;
    for (std::size_t i = 0; i < c.parameters.size() && !evaluator.stopped(); ++i) {
        if (!sided(c.parameters[i]) || is.values[i] == 0.0)
            continue;
        std::vector<double> values = is.values;
        values[i] = std::clamp(-values[i], c.parameters[i].lower, c.parameters[i].upper);
        Point point = fitted.point;
        point.terms.front().values = values;
        const auto there = evaluator.everywhere({point}, Fineness::Fine).front();
        const auto residual = misfit.residual(there);
        if (residual && residual->squaredNorm() + misfit.charge(there).sum() < without)
            starts.push_back(std::move(values));
    }
    return starts;
}

} // namespace

std::vector<Fitted> otherHollows(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                                 const std::vector<Screened>& screened, double without) {
    std::vector<Fitted> found;
    if (fitted.point.terms.size() != 1)
        return found;
    const Term& is = fitted.point.terms.front();
    const Candidate& c = evaluator.model().candidates()[is.candidate];
    const Index place = placeOf(c);
    const auto elsewhere = [&](const std::vector<double>& values) {
        bool other = place >= 0 && apart(valueAt(values, place), valueAt(is.values, place));
        for (std::size_t i = 0; i < values.size() && place < 0; ++i)
            other = other || (sided(c.parameters[i]) && values[i] * is.values[i] < 0.0);
        return other;
    };
    FitSettings settings;
    settings.rival = fitted.misfit;
    for (const std::vector<double>& start :
         place >= 0 ? otherPlaces(is, place, screened) : otherSides(evaluator, misfit, fitted, without)) {
        if (evaluator.stopped())
            break;
        Fitted f = fit(evaluator, misfit, Point{fitted.point.nominal, {{is.candidate, start, is.smoothing}}}, settings,
                       fitted.jacobian.leftCols(static_cast<Index>(fitted.point.nominal.size())));
        if (f.failure.empty() && elsewhere(f.point.terms.front().values))
            found.push_back(std::move(f));
    }
    return found;
}

const Fitted* widenBy(const std::vector<Fitted>& hollows, const Model& model, const Fitted& fitted,
                      const Eigen::VectorXd& dispersions, std::vector<Interval>& intervals) {
    const Variables v(model, fitted.point);
    const bool placed =
        fitted.point.terms.size() != 1 || placeOf(model.candidates()[fitted.point.terms.front().candidate]) >= 0;
    const std::vector<Interval> alone = intervals;
    const Fitted* image = nullptr;
    for (const Fitted& h : hollows) {
        const std::vector<Interval> there = linearIntervals(v, h, h.jacobian, dispersions);
        for (Index k = v.nominal; k < v.size(); ++k) {
            const double left = 1.0 - (h.misfit - fitted.misfit) / (k90 * k90 * dispersions[k]); // of the level
            if (left <= 0.0)
                continue;
            const auto i = static_cast<std::size_t>(k - v.nominal);
            const double reach = std::min(1.0, std::sqrt(left));
            const double low = h.x[k] + reach * (there[i].low - h.x[k]),
                         high = h.x[k] + reach * (there[i].high - h.x[k]);
            // What is 0 within its error has no side.
            if (!placed && sided(v.scalar(k)) && alone[i].low * alone[i].high > 0.0 && low * high > 0.0 &&
                low * alone[i].low < 0.0) {
                const double least =
                    std::min({std::abs(low), std::abs(high), std::abs(alone[i].low), std::abs(alone[i].high)});
                intervals[i].least = intervals[i].eitherSide ? std::min(intervals[i].least, least) : least;
                intervals[i].eitherSide = true;
                image = image == nullptr || h.misfit < image->misfit ? &h : image;
            }
            intervals[i].low = std::min(intervals[i].low, low);
            intervals[i].high = std::max(intervals[i].high, high);
        }
    }
    return image;
}

} // namespace supercircle::diagnosis
