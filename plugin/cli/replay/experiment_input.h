#pragma once
// Reading an experiment for a subcommand; problems go to stderr.

#include "plugin/recording/experiment/experiment.h"

#include <optional>
#include <string>

namespace supercircle::cli {

/// Loads an experiment; prints every problem to stderr (notes too unless `quiet`). Empty: exit 2.
/// @param channel that is to be the first one; empty: as described
[[nodiscard]] std::optional<experiment::Experiment> loadExperiment(const std::string& file, bool quiet,
                                                                   const std::string& channel = {});

/// Folder for an experiment's results: `out`, or if that is empty out/<name of the experiment's folder>_<suffix>.
std::string resultsFolder(const std::string& file, const std::string& out, const std::string& suffix);

} // namespace supercircle::cli
