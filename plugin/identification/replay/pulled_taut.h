#pragma once
// Strips that their supports pull straight (private to replay/).

#include "plugin/recording/experiment/experiment.h"
#include "plugin/scene/loader/scene.h"

#include <string>

namespace supercircle::replay {

/// Why a run pulls a shell of its scene taut, or presses a straight one; empty: it does neither. Rods do not stretch,
/// so two supports that are farther apart than the strip between them is long have no solution, and at that distance
/// the force is undetermined.
/// @param backlash of the drive, m
std::string pulledTaut(const experiment::Experiment& experiment, std::size_t run, const scene::Scene& scene,
                       double backlash);

} // namespace supercircle::replay
