#pragma once
// Score of a law that was found elsewhere, on recordings whose numbers alone are fitted.

#include "plugin/recording/experiment/experiment.h"
#include "supercircle/effects/effect.h"
#include "supercircle/support/result.h"

#include <atomic>
#include <vector>

namespace supercircle::diagnosis {

/// Fits of the stated numbers inside their intervals, without a law and with it.
struct LawScore {
    double rmseWithout = 0.0, rmseWith = 0.0;       ///< of all readings, unit of the channel
    double heldOutWithout = 0.0, heldOutWith = 0.0; ///< of readings that are left out in turn
    double gain = 0.0, gainError = 0.0;             ///< in held-out log score, and its standard error
};

/// The law is not fitted: its numbers stay as they are. Or why there is no score.
Result<LawScore> scoreOfLaw(const experiment::Experiment& experiment, const std::vector<effects::Setting>& law,
                            const std::atomic<bool>* interrupt);

} // namespace supercircle::diagnosis
