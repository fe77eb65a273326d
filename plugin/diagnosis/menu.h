#pragma once
// The catalogue of effects as candidates of one experiment: which numbers of each effect are fitted, on which scale,
// and where searches start. Sizes follow the experiment (its forces, lengths, speeds), not a list of cases.

#include "plugin/diagnosis/model.h"
#include "plugin/experiment/experiment.h"
#include "supercircle/effects/effect.h"

#include <vector>

namespace supercircle::diagnosis {

/// How a candidate's values become a setting of the catalogue.
struct Recipe {
    effects::Setting base;                ///< with its choices made
    std::vector<std::size_t> parameterAt; ///< of each of the candidate's scalars
};

struct Menu {
    std::vector<Candidate> candidates;
    std::vector<Recipe> recipes; ///< one per candidate
};

/// Everything in the catalogue that can act in this experiment; `without` leaves labels out (to test "unexplained").
Menu menuFor(const experiment::Experiment& experiment, const std::vector<std::string>& without = {});

} // namespace supercircle::diagnosis
