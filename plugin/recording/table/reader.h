#pragma once
// A recording back from its files.

#include <string>
#include <string_view>

#include "plugin/recording/table/recording.h"
#include "supercircle/support/result.h"

namespace supercircle::record {

/// What trajectoryJson() wrote. `source` is the name used in messages (source:line:column or a JSON pointer).
[[nodiscard]] Result<Recording> parseTrajectory(std::string_view text, const std::string& source);

/// Puts what summaryJson() wrote into `recording` (summary, parameters, energy, cycles).
[[nodiscard]] Status parseSummary(std::string_view text, const std::string& source, Recording& recording);

/// trajectory.json, series.csv and summary.json of a directory; the last two may be missing.
[[nodiscard]] Result<Recording> readFiles(const std::string& directory);

} // namespace supercircle::record
