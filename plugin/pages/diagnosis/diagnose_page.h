#pragma once
// Result of the subcommand `diagnose` as a JSON file and a page.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/stored_fits.h"
#include "plugin/recording/experiment/experiment.h"

#include <string>

namespace supercircle::cli {

/// diagnosis.json, schema supercircle-diagnosis/2.
/// @param fits for replays; without them the member "replay" is left out
std::string diagnosisJson(const diagnosis::Diagnosis& diagnosis, const diagnosis::StoredFits& fits = {});

/// One self-contained HTML page.
std::string diagnosisPage(const diagnosis::Diagnosis& diagnosis, const experiment::Experiment& experiment);

} // namespace supercircle::cli
