#pragma once
// Score of a law that was found elsewhere, on recordings whose numbers alone are fitted.

#include "plugin/identification/replay/compare.h"
#include "plugin/recording/experiment/experiment.h"
#include "supercircle/effects/effect.h"
#include "supercircle/support/result.h"

#include <atomic>
#include <vector>

namespace supercircle::diagnosis {

/// Fits the stated numbers inside their intervals, without the law and with it. The law is not fitted: its numbers stay
/// as they are. Or why there is no score.
Result<replay::LawScore> scoreOfLaw(const experiment::Experiment& experiment, const std::vector<effects::Setting>& law,
                                    const std::atomic<bool>* interrupt);

} // namespace supercircle::diagnosis
