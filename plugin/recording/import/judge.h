#pragma once
// Whether an imported run can be what it is said to be.

#include "plugin/recording/import/import.h"

#include <string>

namespace supercircle::importing {

/// Refuses a run whose force or displacement says nothing.
/// @return empty, or "LINE:COLUMN: what is wrong; what was expected"
std::string refuse(const Track& track);

/// Doubts about sizes nobody has on a bench (another unit than stated?) and about statements of the header that the
/// rows contradict; they become remarks of the run. Neither stops an import: the experimenter knows better.
void doubt(ImportedRun& run, const Table& table, std::size_t runsOfFile);

} // namespace supercircle::importing
