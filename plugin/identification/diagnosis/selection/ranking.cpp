#include "plugin/identification/diagnosis/selection/ranking.h"

#include "plugin/identification/diagnosis/result/verdict.h"
#include "plugin/identification/diagnosis/selection/fit_learned_laws.h"

#include <algorithm>
#include <cmath>

namespace supercircle::diagnosis {

const std::string& Ranking::labelOf(std::size_t candidate) const {
    return model_.candidates()[candidate].label;
}

bool Ranking::contains(const FittedHypothesis& hypotheses, const std::string& label) const {
    return std::any_of(hypotheses.candidates.begin(), hypotheses.candidates.end(),
                       [&](std::size_t c) { return labelOf(c) == label; });
}

/// The best hypothesis that contains one effect and not another one.
const FittedHypothesis* Ranking::best(const std::string& with, const std::string& without) const {
    const FittedHypothesis* found = nullptr;
    std::size_t at = 0;
    for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
        if (hypotheses_[i].learned || !contains(hypotheses_[i], with) || contains(hypotheses_[i], without) ||
            (found && !weights_.better(i, at)))
            continue;
        found = &hypotheses_[i];
        at = i;
    }
    return found;
}

std::vector<std::string> Ranking::groupOf(const std::vector<Entry>& entries, std::size_t of,
                                          const std::vector<std::string>& with) const {
    const Entry& e = entries[of];
    std::vector<std::string> group = {e.label};
    const FittedHypothesis& s = hypotheses_[e.model];
    for (std::size_t b = 0; b < entries.size(); ++b) {
        const std::string& competitor = entries[b].label;
        if (of == b || std::find(with.begin(), with.end(), competitor) != with.end())
            continue;
        const FittedHypothesis* t = best(competitor, e.label);
        const auto apart =
            t ? likelihood_.whitenedDifference(s.fit.responses, t->fit.responses) : std::optional<Eigen::VectorXd>();
        if ((apart && alike(s.held, t->held, apart->norm(), weights_.dispersion)) ||
            structurallyIndistinguishable(likelihood_.data(), e.label, competitor))
            group.push_back(competitor);
    }
    return group;
}

bool Ranking::corrects(const std::string& label) const {
    return std::any_of(model_.candidates().begin(), model_.candidates().end(),
                       [&](const CandidateEffect& c) { return c.corrects && c.label == label; });
}

bool Ranking::allCorrect(const std::vector<std::string>& labels) const {
    return std::all_of(labels.begin(), labels.end(), [&](const std::string& label) { return corrects(label); });
}

bool Ranking::anyCorrects(const std::vector<std::string>& labels) const {
    return std::any_of(labels.begin(), labels.end(), [&](const std::string& label) { return corrects(label); });
}

double Ranking::probabilityOf(const std::vector<std::string>& group) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < hypotheses_.size(); ++i)
        if (!hypotheses_[i].learned && std::any_of(group.begin(), group.end(), [&](const std::string& label) {
                return contains(hypotheses_[i], label);
            }))
            sum += weights_.effects[i];
    return sum;
}

std::vector<LearnedLaw> Ranking::learned() const {
    std::vector<LearnedLaw> out;
    for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
        if (!hypotheses_[i].learned)
            continue;
        LearnedLaw law = learnedLawOf(model_, likelihood_, hypotheses_[i]);
        law.probability = weights_.effects[i];
        law.gain = weights_.gain[i];
        law.gainError = weights_.gainError[i];
        law.heldOutRmse = hypotheses_[i].held.forceRmse;
        law.point = hypotheses_[i].fit.point;
        out.push_back(std::move(law));
    }
    std::stable_sort(out.begin(), out.end(), [](const LearnedLaw& a, const LearnedLaw& b) {
        return a.probability != b.probability ? a.probability > b.probability : a.gain > b.gain;
    });
    return out;
}

/// Structurally indistinguishable effects share their probability.
void Ranking::shareIndistinguishable(std::vector<Entry>& entries) const {
    for (std::size_t a = 0; a < entries.size(); ++a)
        for (std::size_t b = a + 1; b < entries.size(); ++b)
            if (structurallyIndistinguishable(likelihood_.data(), entries[a].label, entries[b].label))
                entries[a].probability = entries[b].probability =
                    0.5 * (entries[a].probability + entries[b].probability);
}

/// Gain of a label alone.
double Ranking::ownGain(const std::string& label) const {
    double most = -1e300;
    for (std::size_t i = 0; i < hypotheses_.size(); ++i)
        if (!hypotheses_[i].learned && hypotheses_[i].candidates.size() == 1 && contains(hypotheses_[i], label))
            most = std::max(most, weights_.gain[i]);
    return most;
}

std::vector<Entry> Ranking::entries() const {
    std::vector<Entry> out;
    for (std::size_t i = 0; i < hypotheses_.size(); ++i)
        for (std::size_t term = 0; term < hypotheses_[i].candidates.size() && !hypotheses_[i].learned; ++term) {
            const std::string& label = labelOf(hypotheses_[i].candidates[term]);
            const auto at = std::find_if(out.begin(), out.end(), [&](const Entry& e) { return e.label == label; });
            if (at == out.end()) {
                out.push_back({label, i, term, weights_.effects[i]});
                continue;
            }
            at->probability += weights_.effects[i];
            if (weights_.better(i, at->model)) {
                at->model = i;
                at->term = term;
            }
        }
    shareIndistinguishable(out);
    std::stable_sort(out.begin(), out.end(), [&](const Entry& a, const Entry& b) {
        return std::abs(a.probability - b.probability) > 1e-3 ? a.probability > b.probability
                                                              : ownGain(a.label) > ownGain(b.label);
    });
    return out;
}

} // namespace supercircle::diagnosis
