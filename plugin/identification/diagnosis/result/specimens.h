#pragma once
// What the runs say about differences between specimens.

#include "plugin/identification/diagnosis/fit.h"
#include "plugin/identification/diagnosis/result.h"

#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Common values, standard deviations and the values of all specimens, by a fit.
std::vector<BatchResult> presentBatch(const Model& model, const Likelihood& likelihood, const FitResult& fitted);

/// " The specimens differ: frequency by 4 % (90 % interval 2.5 to 8 %)."; empty: nothing shows that they do. Only of a
/// fit that explains the runs: deviations take up what is missing elsewhere.
std::string specimensSentence(const std::vector<BatchResult>& batch);

/// Of standard deviations that are only priors, and of deviations that cannot be told apart.
std::vector<std::string> specimenNotes(const std::vector<BatchResult>& batch);

} // namespace supercircle::diagnosis
