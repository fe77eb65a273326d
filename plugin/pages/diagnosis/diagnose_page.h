#pragma once
// The verb `diagnose` as a JSON file and a page.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/recording/experiment/experiment.h"

#include <string>

namespace supercircle::cli {

/// diagnosis.json (docs/diagnosis.md tells its fields).
std::string diagnosisJson(const diagnosis::Diagnosis& diagnosis);

/// One self-contained HTML page.
std::string diagnosisPage(const diagnosis::Diagnosis& diagnosis, const experiment::Experiment& experiment);

} // namespace supercircle::cli
