#include "plugin/diagnosis/forms.h"

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
    double least = known.fit.misfit - 1.0;
    for (const auto& [candidate, probe] : others) {
        if (evaluator.stopped())
            break;
        fitted.insert(candidate);
        Tried t = fitProbe(evaluator, misfit, base, *probe, known.fit.misfit);
        if (t.fit.failure.empty() && t.fit.misfit < least) {
            least = t.fit.misfit;
            best = std::move(t);
        }
    }
    return best;
}

} // namespace supercircle::diagnosis
