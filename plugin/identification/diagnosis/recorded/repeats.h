#pragma once
// Runs that repeat each other (private to recorded/; decision 0207).

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/noise.h"

#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// Rows of `a` in the motion that it shares with `b`, each with the time, s, at which `b` is at the same place of it.
/// Waiting before the first motion is left out. Empty if they are no repeats.
std::vector<std::pair<Eigen::Index, double>> sharedRows(const RecordedRun& a, const RecordedRun& b);

/// Sets runToRun and repeats of the noise of `data`.
void scatterOfRepeats(const RecordedData& data, Noise& noise);

} // namespace supercircle::diagnosis
