#pragma once
// A hypothesis that was fitted: one effect, two together, or a learned law.

#include "plugin/identification/diagnosis/selection/heldout.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace supercircle::diagnosis {

struct Tried {
    std::vector<std::size_t> candidates; ///< of each term of the point
    Fitted fit;
    HeldOut held;
    std::vector<std::size_t> parts; ///< hypotheses it must beat to count (Weighing::parts)
    bool learned = false;
    std::optional<Fitted> otherSide{}; ///< its mirror image, where these runs do not tell which it is (hollows.h)
};

} // namespace supercircle::diagnosis
