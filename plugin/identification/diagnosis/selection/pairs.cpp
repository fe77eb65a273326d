#include "plugin/identification/diagnosis/selection/pairs.h"

#include "plugin/identification/diagnosis/selection/forms.h"

#include <algorithm>
#include <numeric>
#include <set>

namespace supercircle::diagnosis {

namespace {

using Index = Eigen::Index;

/// The derivatives of a fit have learnt from its steps; what another effect adds is judged by those of its end.
Fitted settled(Evaluator& evaluator, const Misfit& misfit, Fitted f) {
    const Variables v(evaluator.model(), f.point);
    std::vector<Index> all(static_cast<std::size_t>(v.size()));
    std::iota(all.begin(), all.end(), Index{0});
    differentiate(evaluator, misfit, v, f.x, FitSettings{}.difference, all, f.jacobian);
    return f;
}

} // namespace

std::vector<Tried> fitPairs(Evaluator& evaluator, const Misfit& misfit, const std::vector<Tried>& singles,
                            double share) {
    constexpr double kLeast = 12.0;               // squares; less is luck, as with singles, for two
    constexpr double kWorth = 0.25;               // of what the first effect leaves beyond noise
    constexpr double kBehind = 3.0, kNoise = 1.2; // times the best misfit; squares per row
    const Model& model = evaluator.model();
    const auto labelOf = [&](std::size_t candidate) -> const std::string& {
        return model.candidates()[candidate].label;
    };
    std::vector<Tried> pairs;
    std::set<std::pair<std::string, std::string>> known;
    double least = 0.0;
    for (std::size_t i = 0; i < singles.size() && i < 2 && !evaluator.stopped(); ++i) {
        const std::size_t candidate = singles[i].candidates.front();
        const std::string& first = labelOf(candidate);
        const Fitted base = settled(evaluator, misfit, singles[i].fit);
        const std::vector<Screened> screened = screen(evaluator, misfit, base, share);
        std::set<std::size_t> fitted;
        const double excess = base.misfit - static_cast<double>(misfit.present());
        std::size_t taken = 0;
        for (const Probes& probes : byLabel(model, screened, kLeast)) {
            const std::string& second = labelOf(probes.front()->candidate);
            if (second == first)
                continue;
            // The first look is linear and may be wrong by much, but what takes little of a large misfit is not what
            // made it, and a second best effect that is far behind what is there already is not caught up with.
            if (taken >= (i == 0 ? 2U : 1U) || evaluator.stopped() || probes.front()->gain < kWorth * excess ||
                (i > 0 && least > 0.0 && base.misfit - probes.front()->gain > kBehind * least))
                break;
            ++taken;
            if (!known.emplace(std::min(first, second), std::max(first, second)).second)
                continue;
            std::optional<Tried> t = fitLabel(evaluator, misfit, base, probes, least, fitted);
            if (!t)
                continue;
            t->candidates.insert(t->candidates.begin(), candidate);
            if (misfitPerRow(misfit, t->fit) > kNoise && !evaluator.stopped())
                if (auto better = fromStated(evaluator, misfit, *t))
                    t = std::move(better);
            least = std::min(least, t->fit.misfit);
            for (std::size_t k = 0; k < singles.size(); ++k)
                if (const std::string& label = labelOf(singles[k].candidates.front());
                    label == first || label == second)
                    t->parts.push_back(k);
            pairs.push_back(std::move(*t));
        }
    }
    return pairs;
}

} // namespace supercircle::diagnosis
