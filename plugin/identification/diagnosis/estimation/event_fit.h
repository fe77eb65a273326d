#pragma once
// Fit of free oscillations to events: times of passages through the middle, times and heights of the turning points
// between them. The k-th recorded event is compared with the k-th simulated one, so that a wrong frequency has no
// minimum at every whole turn of phase, as samples have (decision 0193).

#include "plugin/identification/diagnosis/fit.h"

#include <optional>
#include <vector>

namespace supercircle::diagnosis {

/// Part of an oscillation between two passages through a level.
struct HalfSwing {
    double from = 0.0;   ///< s, passage at its begin
    double turn = 0.0;   ///< s, turning point
    double height = 0.0; ///< reading there, minus the level
};

/// Half swings of readings about a level; rows that are not numbers are passed over. The first passage begins the
/// first.
/// @param least smallest height; the first smaller one ends the list
std::vector<HalfSwing> halfSwingsOf(const Eigen::VectorXd& time, const Eigen::VectorXd& value, double level,
                                    double least);

/// Start of a fit of samples: the parameters whose events fit best. Nothing where the runs have fewer than three half
/// swings above five standard deviations of the noise, or no simulation oscillates.
[[nodiscard]] std::optional<ParameterPoint> fitEvents(Evaluator& evaluator, const Likelihood& likelihood,
                                                      const ParameterPoint& start);

} // namespace supercircle::diagnosis
