#pragma once
// Figures and page of the subcommand `sensitivity`.

#include "plugin/identification/sensitivity/sensitivity.h"
#include "plugin/recording/table/files.h"
#include "supercircle/support/result.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Result of a sensitivity study.
struct SensitivityStudy {
    experiment::Experiment experiment;
    replay::Resolution resolution;
    sensitivity::Sensitivities result;
    [[nodiscard]] std::string runName(std::size_t run) const; ///< of its files, such as "run_1"
};

/// NAME_sensitivity.png per run, similarity.png and sensitivity.html, by name and content.
Result<std::vector<record::NamedText>> sensitivityPages(const SensitivityStudy& study);

} // namespace supercircle::cli
