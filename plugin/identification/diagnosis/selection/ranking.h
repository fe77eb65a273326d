#pragma once
// Fitted hypotheses ranked as labels. A label may have several (variants, specimens, pairs) and is represented by the
// most probable one.

#include "plugin/identification/diagnosis/selection/fitted_hypothesis.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"

#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// A label of the result and the hypothesis that represents it.
struct Entry {
    std::string label;
    std::size_t model = 0; ///< index of the hypothesis
    std::size_t term = 0;
    double probability = 0.0; ///< sum over all hypotheses that contain it
};

class Ranking {
public:
    /// All arguments must outlive it.
    Ranking(const Model& model, const Likelihood& likelihood, const std::vector<FittedHypothesis>& hypotheses,
            const ModelWeights& weights)
        : model_(model), likelihood_(likelihood), hypotheses_(hypotheses), weights_(weights) {}

    /// Most probable label first; of labels in one hypothesis the one with the larger gain alone.
    [[nodiscard]] std::vector<Entry> entries() const;
    /// Learned laws, most probable first.
    [[nodiscard]] std::vector<LearnedLaw> learned() const;
    /// Labels that these runs cannot distinguish from an entry, itself first.
    /// @param jointWith labels of the same hypothesis, which do not compete
    [[nodiscard]] std::vector<std::string> groupOf(const std::vector<Entry>& entries, std::size_t of,
                                                   const std::vector<std::string>& with) const;
    /// Whether all of these labels, or any, correct the description and add no physics.
    [[nodiscard]] bool allCorrect(const std::vector<std::string>& labels) const;
    [[nodiscard]] bool anyCorrects(const std::vector<std::string>& labels) const;
    /// Probability that any label of a group acts; a pair within the group counts once.
    [[nodiscard]] double probabilityOf(const std::vector<std::string>& group) const;

private:
    [[nodiscard]] const std::string& labelOf(std::size_t candidate) const;
    [[nodiscard]] bool corrects(const std::string& label) const;
    [[nodiscard]] bool contains(const FittedHypothesis& hypotheses, const std::string& label) const;
    [[nodiscard]] const FittedHypothesis* best(const std::string& with, const std::string& without) const;
    [[nodiscard]] double ownGain(const std::string& label) const;
    void shareIndistinguishable(std::vector<Entry>& entries) const;

    const Model& model_;
    const Likelihood& likelihood_;
    const std::vector<FittedHypothesis>& hypotheses_;
    const ModelWeights& weights_;
};

} // namespace supercircle::diagnosis
