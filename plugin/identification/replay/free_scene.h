#pragma once
// Simulation of a freely moving mechanism (private to replay/): the scene with its parameters, simulated as a multibody
// system, with poses sampled at the recorded times.

#include "plugin/identification/replay/simulate.h"

namespace supercircle::replay {

Simulated simulateFree(const experiment::Experiment& experiment, std::size_t run, const Parameters& parameters,
                       const Resolution& resolution, const Options& options);

} // namespace supercircle::replay
