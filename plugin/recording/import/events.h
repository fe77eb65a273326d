#pragma once
// What happens in a recording: saturation of the sensor, a break, sudden falls of the force.

#include "plugin/recording/import/import.h"

namespace supercircle::importing {

/// Rows at the limit of the sensor lose their force (`--keep saturation`: they keep it).
void censorSaturation(ImportedRun& run, const Hints& hints);

/// Points of a table at which the gauge is at its end lose their displacement (`--keep saturation`: they keep it).
void censorGauge(ImportedRun& run, const Hints& hints);

/// Tells gaps of a run, and sudden falls and a break if its force is zeroed. Rows after them stay; `--cut gaps`,
/// `--cut falls`, `--cut break`: they go.
void findEvents(ImportedRun& run, const Hints& hints);

} // namespace supercircle::importing
