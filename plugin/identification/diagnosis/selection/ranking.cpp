#include "plugin/identification/diagnosis/selection/ranking.h"

#include "plugin/identification/diagnosis/result/conclude.h"
#include "plugin/identification/diagnosis/selection/learn.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

const std::string& Ranking::labelOf(std::size_t candidate) const {
    return model_.candidates()[candidate].label;
}

bool Ranking::contains(const Tried& tried, const std::string& label) const {
    return std::any_of(tried.candidates.begin(), tried.candidates.end(),
                       [&](std::size_t c) { return labelOf(c) == label; });
}

/// The best hypothesis with an effect and without another one: beside it nothing is its rival, but alone it may be.
const Tried* Ranking::best(const std::string& with, const std::string& without) const {
    const Tried* found = nullptr;
    std::size_t at = 0;
    for (std::size_t i = 0; i < tried_.size(); ++i) {
        if (tried_[i].learned || !contains(tried_[i], with) || contains(tried_[i], without) ||
            (found && !weighed_.better(i, at)))
            continue;
        found = &tried_[i];
        at = i;
    }
    return found;
}

std::vector<std::string> Ranking::groupOf(const std::vector<Entry>& entries, std::size_t of,
                                          const std::vector<std::string>& with) const {
    const Entry& e = entries[of];
    std::vector<std::string> group = {e.label};
    const Tried& s = tried_[e.model];
    for (std::size_t b = 0; b < entries.size(); ++b) {
        const std::string& rival = entries[b].label;
        if (of == b || std::find(with.begin(), with.end(), rival) != with.end())
            continue;
        const Tried* t = best(rival, e.label);
        const auto apart = t ? misfit_.difference(s.fit.responses, t->fit.responses) : std::optional<Eigen::VectorXd>();
        if ((apart && alike(s.held, t->held, apart->norm(), weighed_.dispersion)) ||
            alikeByNature(misfit_.data(), e.label, rival))
            group.push_back(rival);
    }
    return group;
}

double Ranking::probabilityOf(const std::vector<std::string>& group) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < tried_.size(); ++i)
        if (!tried_[i].learned && std::any_of(group.begin(), group.end(),
                                              [&](const std::string& label) { return contains(tried_[i], label); }))
            sum += weighed_.effects[i];
    return sum;
}

std::vector<LearnedLaw> Ranking::learned() const {
    std::vector<LearnedLaw> out;
    for (std::size_t i = 0; i < tried_.size(); ++i) {
        if (!tried_[i].learned)
            continue;
        LearnedLaw law = describe(model_, misfit_, tried_[i]);
        law.probability = weighed_.effects[i];
        law.gain = weighed_.gain[i];
        law.gainError = weighed_.gainError[i];
        law.heldOutRmse = tried_[i].held.forceRmse;
        out.push_back(std::move(law));
    }
    std::stable_sort(out.begin(), out.end(), [](const LearnedLaw& a, const LearnedLaw& b) {
        return a.probability != b.probability ? a.probability > b.probability : a.gain > b.gain;
    });
    return out;
}

/// Which of two that are alike by nature fits better is no evidence for either: they share what they have.
void Ranking::shareAlike(std::vector<Entry>& entries) const {
    for (std::size_t a = 0; a < entries.size(); ++a)
        for (std::size_t b = a + 1; b < entries.size(); ++b)
            if (alikeByNature(misfit_.data(), entries[a].label, entries[b].label))
                entries[a].probability = entries[b].probability =
                    0.5 * (entries[a].probability + entries[b].probability);
}

/// Of a label by itself.
double Ranking::ownGain(const std::string& label) const {
    double most = -1e300;
    for (std::size_t i = 0; i < tried_.size(); ++i)
        if (!tried_[i].learned && tried_[i].candidates.size() == 1 && contains(tried_[i], label))
            most = std::max(most, weighed_.gain[i]);
    return most;
}

std::vector<Entry> Ranking::entries() const {
    std::vector<Entry> out;
    for (std::size_t i = 0; i < tried_.size(); ++i)
        for (std::size_t term = 0; term < tried_[i].candidates.size() && !tried_[i].learned; ++term) {
            const std::string& label = labelOf(tried_[i].candidates[term]);
            const auto at = std::find_if(out.begin(), out.end(), [&](const Entry& e) { return e.label == label; });
            if (at == out.end()) {
                out.push_back({label, i, term, weighed_.effects[i]});
                continue;
            }
            at->probability += weighed_.effects[i];
            if (weighed_.better(i, at->model)) {
                at->model = i;
                at->term = term;
            }
        }
    shareAlike(out);
    std::stable_sort(out.begin(), out.end(), [&](const Entry& a, const Entry& b) {
        return std::abs(a.probability - b.probability) > 1e-3 ? a.probability > b.probability
                                                              : ownGain(a.label) > ownGain(b.label);
    });
    return out;
}

} // namespace supercircle::diagnosis
