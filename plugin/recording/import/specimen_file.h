#pragma once
// The file with the specimen, or with any part of an experiment, that the user gives.

#include "plugin/recording/import/signals.h"

#include <string>

namespace supercircle::importing {

/// The text of the file, which is a JSON object. An error names file, line and column.
Result<std::string> readSpecimenFile(const std::string& file);

/// "none", "0..0.5" (s), "8.1" (N), or "the mean reading of the first 0.5 s is subtracted".
Result<ForceZero> parseForceZero(const std::string& words);

/// `sensors.force_zero` of the file; from the data if the file does not state it.
Result<ForceZero> statedForceZero(const std::string& file);

} // namespace supercircle::importing
