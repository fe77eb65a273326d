#pragma once
// The page of the validation experiments.

#include "plugin/lab/validation/experiment.h"
#include "plugin/recording/table/files.h"

#include <vector>

namespace supercircle::pages {

/// validation.html (self-contained), validation.json and one validation_ID.png per experiment, by name and content.
[[nodiscard]] Result<std::vector<record::NamedText>>
validationFiles(const std::vector<validation::ValidationExperiment>& all,
                const validation::ValidationSettings& settings);

} // namespace supercircle::pages
