#pragma once
// Hypotheses that were fitted, put in order as labels: a label may have several (forms of its law, specimens, other
// effects beside it), and is shown by the most probable one.

#include "plugin/identification/diagnosis/selection/tried.h"
#include "plugin/identification/diagnosis/selection/weigh.h"

#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// A label of the report and the hypothesis it is best shown by.
struct Entry {
    std::string label;
    std::size_t model = 0; ///< of the hypotheses
    std::size_t term = 0;
    double probability = 0.0; ///< of all hypotheses that contain it
};

class Ranking {
public:
    /// All must outlive it.
    Ranking(const Model& model, const Misfit& misfit, const std::vector<Tried>& tried, const Weighed& weighed)
        : model_(model), misfit_(misfit), tried_(tried), weighed_(weighed) {}

    /// The most probable label first; of labels that act together the one that explains more by itself.
    [[nodiscard]] std::vector<Entry> entries() const;
    /// Laws that were learned, the most probable first.
    [[nodiscard]] std::vector<LearnedLaw> learned() const;
    /// Labels that these runs cannot tell from one of the entries, itself first.
    /// @param with labels that act beside it in its best model: they are no rivals
    [[nodiscard]] std::vector<std::string> groupOf(const std::vector<Entry>& entries, std::size_t of,
                                                   const std::vector<std::string>& with) const;
    /// That something of a group acts: a pair of two of it is one hypothesis.
    [[nodiscard]] double probabilityOf(const std::vector<std::string>& group) const;

private:
    [[nodiscard]] const std::string& labelOf(std::size_t candidate) const;
    [[nodiscard]] bool contains(const Tried& tried, const std::string& label) const;
    [[nodiscard]] const Tried* best(const std::string& with, const std::string& without) const;
    [[nodiscard]] double ownGain(const std::string& label) const;
    void shareAlike(std::vector<Entry>& entries) const;

    const Model& model_;
    const Misfit& misfit_;
    const std::vector<Tried>& tried_;
    const Weighed& weighed_;
};

} // namespace supercircle::diagnosis
