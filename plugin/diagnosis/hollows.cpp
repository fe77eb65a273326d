#include "plugin/diagnosis/hollows.h"

#include "plugin/diagnosis/profile.h"

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

} // namespace

std::vector<Fitted> otherHollows(Evaluator& evaluator, const Misfit& misfit, const Fitted& fitted,
                                 const std::vector<Screened>& screened) {
    std::vector<Fitted> found;
    if (fitted.point.terms.size() != 1)
        return found;
    const Term& is = fitted.point.terms.front();
    const Index place = placeOf(evaluator.model().candidates()[is.candidate]);
    if (place < 0)
        return found;
    const auto at = [&](const std::vector<double>& values) { return values[static_cast<std::size_t>(place)]; };
    const auto elsewhere = [&](const std::vector<double>& a, const std::vector<double>& b) {
        return std::abs(at(a) - at(b)) > kElsewhere;
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
    starts.back()[static_cast<std::size_t>(place)] = 1.0 - at(is.values);
    if (!elsewhere(starts.back(), is.values))
        starts.pop_back();
    FitSettings settings;
    settings.rival = fitted.misfit;
    for (const std::vector<double>& start : starts) {
        if (evaluator.stopped())
            break;
        Fitted f = fit(evaluator, misfit, Point{fitted.point.nominal, {{is.candidate, start, is.smoothing}}}, settings,
                       fitted.jacobian.leftCols(static_cast<Index>(fitted.point.nominal.size())));
        if (f.failure.empty() && elsewhere(f.point.terms.front().values, is.values))
            found.push_back(std::move(f));
    }
    return found;
}

void widenBy(const std::vector<Fitted>& hollows, const Variables& v, const Fitted& fitted,
             const Eigen::VectorXd& dispersions, std::vector<Interval>& intervals) {
    for (const Fitted& h : hollows) {
        const std::vector<Interval> there = linearIntervals(v, h, h.jacobian, dispersions);
        for (Index k = v.nominal; k < v.size(); ++k) {
            const double left = 1.0 - (h.misfit - fitted.misfit) / (k90 * k90 * dispersions[k]); // of the level
            if (left <= 0.0)
                continue;
            const auto i = static_cast<std::size_t>(k - v.nominal);
            const double reach = std::min(1.0, std::sqrt(left));
            intervals[i].low = std::min(intervals[i].low, h.x[k] + reach * (there[i].low - h.x[k]));
            intervals[i].high = std::max(intervals[i].high, h.x[k] + reach * (there[i].high - h.x[k]));
        }
    }
}

} // namespace supercircle::diagnosis
