#pragma once
// Two effects at a time. The second one is looked for in what the first leaves, because beside a strong effect a weak
// one does not rank among the best alone, and with the first one in place: a soft machine moves a strip's touch by
// half a millimetre, and what the bare simulation says viscosity would do lies elsewhere in the recording.

#include "plugin/identification/diagnosis/screening/screen.h"
#include "plugin/identification/diagnosis/selection/tried.h"

namespace supercircle::diagnosis {

/// Fits the best single effect with the two that explain most of what it leaves, and the second best with one.
/// @param singles best first; those whose pairs are tried
/// @param share of the probes' sizes at which effects are simulated (screen())
std::vector<Tried> fitPairs(Evaluator& evaluator, const Misfit& misfit, const std::vector<Tried>& singles,
                            double share = 1.0);

} // namespace supercircle::diagnosis
