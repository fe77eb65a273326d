#pragma once
// Recordings of a freely moving mechanism: cut at the release, averaged, and described (private to import/).

#include "plugin/recording/import/import.h"
#include "plugin/recording/import/template.h"

#include <string>
#include <vector>

namespace supercircle::importing {

/// Removes the rows before a turning point of the angle. 1: the first, which ends the lift by hand. After a slow
/// release the hand drags through the first half oscillation, so the second is safe.
void cutToTurningPoint(Signals& signals, int which, std::vector<Remark>& remarks);

/// Means of blocks of `size` rows.
void average(Signals& signals, int size, std::vector<Remark>& remarks);

/// experiment.json of angle-only runs.
Result<Description> describeFree(const Imported& imported, const TemplateOptions& options);

} // namespace supercircle::importing
