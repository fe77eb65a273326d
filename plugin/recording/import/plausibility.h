#pragma once
// Plausibility of an imported run.

#include "plugin/recording/import/import.h"

namespace supercircle::importing {

/// Fails for a run with a constant or mostly missing channel: "LINE:COLUMN: what is wrong; what was expected".
Status checkPlausible(const Signals& signals);

/// Adds remarks about implausible sizes (another unit?) and header entries that contradict the rows. They do not stop
/// an import.
void addDoubts(ImportedRun& run, const Table& table, std::size_t runsOfFile);

} // namespace supercircle::importing
