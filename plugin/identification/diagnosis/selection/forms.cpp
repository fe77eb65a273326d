#include "plugin/identification/diagnosis/selection/forms.h"

#include <algorithm>
#include <map>

namespace supercircle::diagnosis {

Tried fitProbe(Evaluator& evaluator, const Misfit& misfit, const Fitted& base, const Screened& probe, double rival) {
    Point start = base.point;
    start.terms.push_back({probe.candidate, settledValues(evaluator, misfit, base, probe)});
    FitSettings given;
    given.rival = rival;
    Tried t;
    t.candidates = {probe.candidate};
    t.fit = fit(evaluator, misfit, start, given, base.jacobian);
    return t;
}

std::vector<Probes> byLabel(const Model& model, const std::vector<Screened>& screened, double least) {
    std::map<std::string, Probes> labels;
    for (const Screened& s : screened)
        if (s.simulated && s.gain > least)
            labels[model.candidates()[s.candidate].label].push_back(&s);
    std::vector<Probes> ranked;
    for (auto& [label, probes] : labels) {
        std::stable_sort(probes.begin(), probes.end(),
                         [](const Screened* a, const Screened* b) { return a->gain > b->gain; });
        ranked.push_back(probes);
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const Probes& a, const Probes& b) { return a.front()->gain > b.front()->gain; });
    return ranked;
}

namespace {

Probes startsOf(const Probes& probes, bool allForms) {
    const Screened& first = *probes.front();
    Probes starts = {&first};
    for (const Screened* p : probes)
        if (starts.size() < 2 && p->candidate != first.candidate && p->gain > 0.3 * first.gain)
            starts.push_back(p);
    // Free runs are cheap, and what a base that lost its beat says of forms is worth little: each gets its chance.
    for (const Screened* p : probes)
        if (allForms &&
            std::none_of(starts.begin(), starts.end(), [&](const Screened* s) { return s->candidate == p->candidate; }))
            starts.push_back(p);
    if (probes.size() > 1 && starts.size() < 2 && probes[1]->gain > 0.3 * first.gain)
        starts.push_back(probes[1]);
    return starts;
}

/// Squares that forms of a law are compared by: a number more has to explain two (H. Akaike, IEEE Trans. Autom. Control
/// 19 (1974) 716).
double priced(const Tried& t) {
    return t.fit.misfit + 2.0 * static_cast<double>(t.fit.x.size());
}

} // namespace

std::optional<Tried> fitLabel(Evaluator& evaluator, const Misfit& misfit, const Fitted& base, const Probes& probes,
                              double& least, std::set<std::size_t>& fitted) {
    std::optional<Tried> best;
    for (const Screened* s : startsOf(probes, misfit.data().free)) {
        if (evaluator.stopped())
            break;
        fitted.insert(s->candidate);
        Tried t = fitProbe(evaluator, misfit, base, *s, least);
        if (!t.fit.failure.empty())
            continue;
        least = least > 0.0 ? std::min(least, t.fit.misfit) : t.fit.misfit;
        if (!best || priced(t) < priced(*best))
            best = std::move(t);
    }
    return best;
}

std::optional<Tried> fromStated(Evaluator& evaluator, const Misfit& misfit, const Tried& known) {
    Tried again = known;
    Point start = known.fit.point;
    const std::vector<Scalar>& stated = evaluator.model().nominal();
    for (std::size_t i = 0; i < stated.size(); ++i)
        start.nominal[i] = stated[i].value;
    FitSettings given;
    given.rival = known.fit.misfit;
    again.fit = fit(evaluator, misfit, start, given);
    if (!again.fit.failure.empty() || again.fit.misfit > known.fit.misfit - 1.0)
        return std::nullopt;
    return again;
}

std::optional<Tried> betterForm(Evaluator& evaluator, const Misfit& misfit, const Fitted& base,
                                const std::vector<Screened>& screened, const Tried& known,
                                std::set<std::size_t>& fitted) {
    const std::vector<Candidate>& all = evaluator.model().candidates();
    std::map<std::size_t, const Screened*> others; // best probe by candidate
    for (const Screened& s : screened)
        if (s.simulated && all[s.candidate].label == all[known.candidates.front()].label &&
            fitted.count(s.candidate) == 0)
            if (const auto at = others.emplace(s.candidate, &s).first; s.gain > at->second->gain)
                at->second = &s;
    std::optional<Tried> best;
    double least = priced(known) - 1.0;
    for (const auto& [candidate, probe] : others) {
        if (evaluator.stopped())
            break;
        fitted.insert(candidate);
        Tried t = fitProbe(evaluator, misfit, base, *probe, known.fit.misfit);
        if (t.fit.failure.empty() && priced(t) < least) {
            least = priced(t);
            best = std::move(t);
        }
    }
    return best;
}

} // namespace supercircle::diagnosis
