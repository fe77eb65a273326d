#include "plugin/diagnosis/pairs.h"

#include "plugin/diagnosis/forms.h"

#include <algorithm>
#include <set>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// Probes of other labels by what they explain of the single's residual, one per label, best first.
std::vector<Screened> complements(const Model& model, const std::vector<Screened>& screened, const Tried& single) {
    const Variables v(model, single.fit.point);
    std::vector<Screened> best;
    for (const Screened& s : screened) {
        const std::string& label = model.candidates()[s.candidate].label;
        if (!s.simulated || s.size <= 1e-6 || label == model.candidates()[single.candidates.front()].label)
            continue;
        Screened again = s;
        again.values = model.candidates()[s.candidate].probes[s.probe];
        explain(single.fit, v, model.candidates()[s.candidate], again);
        const auto same = std::find_if(best.begin(), best.end(), [&](const Screened& b) {
            return model.candidates()[b.candidate].label == label;
        });
        if (same == best.end())
            best.push_back(again);
        else if (again.gain > same->gain)
            *same = again;
    }
    std::stable_sort(best.begin(), best.end(), [](const Screened& a, const Screened& b) { return a.gain > b.gain; });
    return best;
}

} // namespace

std::vector<Tried> fitPairs(Evaluator& evaluator, const Misfit& misfit, const std::vector<Screened>& screened,
                            const std::vector<Tried>& singles) {
    const Model& model = evaluator.model();
    std::vector<Tried> pairs;
    std::set<std::pair<std::string, std::string>> known;
    double least = 0.0;
    for (std::size_t i = 0; i < singles.size() && i < 2; ++i) {
        const std::string& first = model.candidates()[singles[i].candidates.front()].label;
        std::size_t taken = 0;
        for (const Screened& s : complements(model, screened, singles[i])) {
            const std::string& second = model.candidates()[s.candidate].label;
            if (taken >= (i == 0 ? 2U : 1U) || s.gain < 12.0 || evaluator.stopped())
                break;
            ++taken;
            if (!known.emplace(std::min(first, second), std::max(first, second)).second)
                continue;
            Tried t = fitProbe(evaluator, misfit, singles[i].fit, s, least);
            t.candidates.insert(t.candidates.begin(), singles[i].candidates.front());
            if (!t.fit.failure.empty())
                continue;
            least = least > 0.0 ? std::min(least, t.fit.misfit) : t.fit.misfit;
            for (std::size_t k = 0; k < singles.size(); ++k)
                if (const std::string& label = model.candidates()[singles[k].candidates.front()].label;
                    label == first || label == second)
                    t.parts.push_back(k);
            pairs.push_back(std::move(t));
        }
    }
    return pairs;
}

} // namespace supercircle::diagnosis
