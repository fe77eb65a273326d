#pragma once
// Plausibility of an imported run.

#include "plugin/recording/import/import.h"

#include <string>

namespace supercircle::importing {

/// Error for a run with a constant or mostly missing channel.
/// @return empty, or "LINE:COLUMN: what is wrong; what was expected"
std::string implausible(const Signals& signals);

/// Adds remarks about implausible sizes (another unit?) and header entries that contradict the rows. They do not stop
/// an import.
void addDoubts(ImportedRun& run, const Table& table, std::size_t runsOfFile);

} // namespace supercircle::importing
