#pragma once
// A fitted hypothesis: one effect, two effects, or a learned law.

#include "plugin/identification/diagnosis/selection/cross_validation.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace supercircle::diagnosis {

struct FittedHypothesis {
    std::vector<std::size_t> candidates; ///< of each term of the point
    FitResult fit;
    PredictiveScore held;
    std::vector<std::size_t> mustBeat; ///< indices of hypotheses that it must beat (WeightingInput::mustBeat)
    bool learned = false;
    int starts = 0, agreed = 0; ///< fits of the same law from other starts, and those within 2 of the least chi-squared
    std::optional<FitResult> mirrorImage{}; ///< mirror image, if the runs do not resolve the sign (local_minima.h)
};

} // namespace supercircle::diagnosis
