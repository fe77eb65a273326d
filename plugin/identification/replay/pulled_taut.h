#pragma once
// Strips that their supports pull straight (private to replay/).

#include "plugin/recording/experiment/experiment.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/effects/effect.h"

#include <string>
#include <vector>

namespace supercircle::replay {

/// Why a run pulls a shell of its scene taut, or presses a straight one; empty: it does neither. Rods do not stretch,
/// so two supports that are farther apart than the strip between them is long have no solution, and at that distance
/// the force is undetermined.
/// @param settings effects, of which the backlash of the drive counts
std::string pulledTaut(const experiment::Experiment& experiment, std::size_t run, const scene::Scene& scene,
                       const std::vector<effects::Setting>& settings);

} // namespace supercircle::replay
