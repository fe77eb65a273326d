#pragma once
// Landmarks: quantities of a whole run where a pointwise comparison is meaningless. They are displacement and size of
// jumps, work of each segment, first contact and release.
//
// They are measured alike on recorded and simulated curves. A simulated curve is known between its samples, so its
// jumps are exact; those of a recording are known to half a sample (Landmarks::samplingError).

#include "plugin/identification/replay/compare.h"
#include "plugin/recording/experiment/experiment.h"

#include <limits>
#include <string>
#include <vector>

namespace supercircle::sensitivity {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN(); ///< of what could not be measured

/// Vectors of equal length; NaN: could not be measured.
struct Landmarks {
    std::vector<std::string> names; ///< "jump1_displacement", "segment2_work", ...
    std::vector<std::string> units; ///< "m", "N", "J"
    std::vector<double> values;
    std::vector<double> samplingError; ///< half-width left open by the sampling, 0: none
    std::vector<replay::Landmark> jumps;
};

/// Measures all landmarks of a curve, jumps numbered by time:
/// - jumpK_displacement (m), jumpK_before, jumpK_after, jumpK_drop (N): force before and after the jump, difference;
/// - peak_force, peak_displacement, min_force;
/// - first_contact_displacement, release_displacement: where the force first and last exceeds 2 % of its largest
/// magnitude, interpolated; residual_displacement: their difference (m);
/// - segmentK_work (J): integral of force over displacement along each segment; loop_area (J): sum.
/// @param trace the same curve between its samples; nullptr: none
Landmarks measure(const experiment::Run& run, const experiment::Readings& readings,
                  const experiment::Readings* trace = nullptr);

/// The same for another curve of the run, with jumps matched to `reference` (nearest in time, same direction, at most
/// `farthest` seconds apart): same names, NaN for a jump without partner.
Landmarks measureLike(const Landmarks& reference, const experiment::Run& run, const experiment::Readings& readings,
                      const experiment::Readings* trace = nullptr, double farthest = 1.0);

} // namespace supercircle::sensitivity
