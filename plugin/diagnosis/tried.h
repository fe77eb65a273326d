#pragma once
// A hypothesis that was fitted: one effect, two together, or a learned law.

#include "plugin/diagnosis/heldout.h"

#include <cstddef>
#include <vector>

namespace supercircle::diagnosis {

struct Tried {
    std::vector<std::size_t> candidates; ///< of each term of the point
    Fitted fit;
    HeldOut held;
    std::vector<std::size_t> parts; ///< hypotheses it must beat to count (Weighing::parts)
    bool learned = false;
};

} // namespace supercircle::diagnosis
