#include "plugin/identification/diagnosis/next_experiment/suspects.h"

#include "plugin/identification/diagnosis/selection/forms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace supercircle::diagnosis {

namespace {

constexpr std::size_t kMost = 4;
constexpr double kLeast = 0.02; ///< probability that is worth a run

Rival rivalOf(const Model& model, const Misfit& misfit, const std::string& label, const Fitted& f, double weight) {
    return {label, f.point, f.x, posteriorOf(Variables(model, f.point), f.jacobian, misfitPerRow(misfit, f)), weight};
}

/// What explains most at first sight, as fitted, if need be now; weights by that, of the best one 1.
std::vector<Rival> promising(Evaluator& evaluator, const Misfit& misfit, const Fitted& base,
                             const std::vector<Named>& named, const std::vector<Screened>& screened) {
    constexpr double kFar = 6.0; // squares: a factor of twenty
    const std::vector<Candidate>& candidates = evaluator.model().candidates();
    std::vector<const Screened*> best;
    for (const Screened& s : screened)
        if (s.gain > 0.0 && !candidates[s.candidate].learned)
            best.push_back(&s);
    std::stable_sort(best.begin(), best.end(), [](const Screened* a, const Screened* b) { return a->gain > b->gain; });
    std::vector<Rival> out;
    double least = std::numeric_limits<double>::infinity();
    for (const Screened* s : best) {
        const std::string& label = candidates[s->candidate].label;
        if (out.size() == kMost || s->gain < best.front()->gain - kFar || evaluator.stopped())
            break;
        if (std::any_of(out.begin(), out.end(), [&](const Rival& r) { return r.label == label; }))
            continue;
        const auto known = std::find_if(named.begin(), named.end(), [&](const Named& n) {
            return n.label == label && n.shown->candidates.size() == 1;
        });
        const Tried t = known != named.end() ? *known->shown : fitProbe(evaluator, misfit, base, *s, 0.0);
        if (!t.fit.failure.empty())
            continue;
        least = std::min(least, t.fit.misfit);
        out.push_back(rivalOf(evaluator.model(), misfit, label, t.fit, t.fit.misfit));
    }
    for (Rival& r : out)
        r.weight = std::exp(0.5 * (least - r.weight));
    return out;
}

} // namespace

std::vector<Rival> suspects(Evaluator& evaluator, const Misfit& misfit, const Fitted& base,
                            const std::vector<Named>& named, const std::vector<Screened>& screened, double nothing) {
    std::vector<Rival> out;
    std::set<const Tried*> taken; // what acts together is one suspect
    for (std::size_t i = 0; i < named.size() && out.size() < kMost && nothing < 0.5; ++i) {
        const Named& n = named[i];
        if ((n.twin || n.probability >= kLeast) && taken.insert(n.shown).second)
            out.push_back(rivalOf(evaluator.model(), misfit, n.label, n.shown->fit, std::max(kLeast, n.probability)));
    }
    // Of the first one its mirror image, too: which of the two it is.
    if (!out.empty() && named.front().shown->otherSide) {
        out.front().weight *= 0.5;
        out.push_back(rivalOf(evaluator.model(), misfit, named.front().label, *named.front().shown->otherSide,
                              out.front().weight));
        out.back().otherSide = true;
    }
    const double first = out.empty() ? 1.0 : out.front().weight;
    if (out.size() < kMost)
        for (Rival& r : promising(evaluator, misfit, base, named, screened)) {
            const bool there = std::any_of(out.begin(), out.end(), [&](const Rival& o) { return o.label == r.label; });
            if (there || out.size() == kMost)
                continue;
            r.weight *= first;
            out.push_back(std::move(r));
        }
    if (out.size() == 1 || (!out.empty() && nothing >= kLeast))
        out.push_back(rivalOf(evaluator.model(), misfit, "nothing", base, 0.0));
    return out;
}

} // namespace supercircle::diagnosis
