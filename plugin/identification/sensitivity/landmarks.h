#pragma once
// Numbers that stand for a whole run where a pointwise comparison means nothing: where it jumps and by how much, what a
// leg of the motion costs, where the specimen is touched and let go.
//
// They are measured alike on recorded and on simulated curves. A simulated curve is known between its samples (its
// trace), so its jumps are placed exactly; in a recording they are known to half a sample (Landmarks::grain).

#include "plugin/identification/replay/compare.h"
#include "plugin/recording/experiment/experiment.h"

#include <string>
#include <vector>

namespace supercircle::sensitivity {

/// Values of equal length; what could not be measured is NaN.
struct Landmarks {
    std::vector<std::string> names; ///< "jump1_displacement", "leg2_work", ...
    std::vector<std::string> units; ///< "m", "N", "J"
    std::vector<double> values;
    std::vector<double> grain; ///< half-width of what the samples leave open, 0: nothing
    std::vector<replay::Landmark> jumps;
};

/// Everything that can be measured on one curve, jumps numbered in the order of time:
/// - jumpK_displacement (m), jumpK_before, jumpK_after, jumpK_drop (N): force ahead of the jump, behind it, difference;
/// - peak_force, peak_displacement, least_force: largest and least force and where the largest is;
/// - touch_displacement, release_displacement: where the force first and last exceeds 2 % of its largest size, between
///   samples linearly; residual_displacement: their difference (m);
/// - legK_work (J): integral of force over displacement along each leg of the commanded motion; loop_area (J): sum.
/// @param trace the same curve between its samples; nullptr: there is none
Landmarks measure(const experiment::Run& run, const experiment::Readings& readings,
                  const experiment::Readings* trace = nullptr);

/// The same measured on another curve of the same run, jumps matched to those of `reference` (nearest in time, same
/// direction, at most `farthest` seconds apart): same names, NaN for a jump without partner.
Landmarks measureLike(const Landmarks& reference, const experiment::Run& run, const experiment::Readings& readings,
                      const experiment::Readings* trace = nullptr, double farthest = 1.0);

} // namespace supercircle::sensitivity
