#pragma once
// Which further run would tell the leading rivals apart.

#include "plugin/diagnosis/model.h"
#include "plugin/diagnosis/noise.h"
#include "plugin/diagnosis/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// A model in question, with its fitted values.
struct Rival {
    std::string label;
    Point point;
};

/// Simulates every design with the first two rivals that are not alike (or the first two) and takes the one whose
/// predictions lie farthest apart in noise units, a constant shift taken out. Its power is that of a one-sided test at
/// 5 % between the two, Phi(d - 1.645) with d the distance: an upper bound, because the nominal parameters would be
/// fitted again. Empty if no design can be simulated.
std::optional<NextExperiment> nextExperiment(const Model& model, const std::vector<Rival>& rivals, const Noise& noise,
                                             const std::vector<std::string>& group);

} // namespace supercircle::diagnosis
