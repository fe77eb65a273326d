#pragma once
// The pictures and the page of the verb `sensitivity`.

#include "plugin/identification/sensitivity/sensitivity.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/result.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Everything the verb found out.
struct SensitivityStudy {
    experiment::Experiment experiment;
    replay::Resolution resolution;
    sensitivity::Sensitivities result;
    [[nodiscard]] std::string runName(std::size_t run) const; ///< of its files, "run_1"
};

/// NAME_sensitivity.png per run, similarity.png and sensitivity.html, by name and content.
record::Result<std::vector<record::NamedText>> sensitivityPages(const SensitivityStudy& study);

} // namespace supercircle::cli
