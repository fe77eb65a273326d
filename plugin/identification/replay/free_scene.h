#pragma once
// Runs of a mechanism that moves by itself (private to replay/): the scene with its parameters put in, played by a
// Linkage, its pose read at the recording's times.

#include "plugin/identification/replay/simulate.h"

namespace supercircle::replay {

Simulated simulateFree(const experiment::Experiment& experiment, std::size_t run, const Parameters& parameters,
                       const Resolution& resolution, const Options& options);

} // namespace supercircle::replay
