#pragma once
// Slip of a shell's tips on their support, and the friction coefficient at which slip begins.

#include "plugin/lab/validation/simulation.h"

namespace supercircle::validation {

/// What the tips stand on.
enum class Support { Cylinder /**< about the origin */, Floor /**< horizontal */ };

/// Slip of the tip of shell 0 that moved more between the first and the last frame, m. Rolling of the round tip (radius
/// half the thickness) is subtracted. Both tips count: with an odd number of arcs the middle arc couples the two
/// halves, and one tip may stick where the other slips.
double tipSlip(const record::Recording& recording, Support support);

/// Smallest value at which `sticks` holds, between `low` and `high`, to 2^-steps of the interval.
double bisect(double low, double high, int steps, const std::function<bool(double)>& sticks);

} // namespace supercircle::validation
