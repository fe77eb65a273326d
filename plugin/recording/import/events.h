#pragma once
// What happens in a recording: saturation of the sensor, a break, sudden falls of the force.

#include "plugin/recording/import/import.h"

namespace supercircle::importing {

/// Tells the events of a run. Rows at the limit of the sensor lose their force (`--keep saturation`: they stay); rows
/// after a break stay (`--cut break`: they go).
void findEvents(ImportedRun& run, const Hints& hints);

} // namespace supercircle::importing
