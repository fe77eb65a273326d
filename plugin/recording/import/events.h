#pragma once
// What happens in a recording: saturation of the sensor, a break, sudden falls of the force.

#include "plugin/recording/import/import.h"

namespace supercircle::importing {

/// Rows at the limit of the sensor lose their force (`--keep saturation`: they keep it).
void censorSaturation(ImportedRun& run, const Hints& hints);

/// Tells sudden falls and a break of a run whose force is zeroed. Rows after them stay; `--cut falls`, `--cut break`:
/// they go.
void findEvents(ImportedRun& run, const Hints& hints);

} // namespace supercircle::importing
