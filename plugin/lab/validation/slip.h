#pragma once
// How far the tips of a shell slipped on what they stand on, and where the boundary of slip lies.

#include "plugin/lab/validation/play.h"

namespace supercircle::validation {

/// What the tips stand on.
enum class Ground { Cylinder /**< about the origin */, Floor /**< horizontal */ };

/// Slip of the tip of shell 0 that moved more between the first and the last kept frame, m. The end of the centre line
/// also moves when the round tip (radius half the thickness) merely rolls; that part is taken off. Both tips are looked
/// at: the middle arc of an odd number couples the two halves, and then one tip may stick where the other still slips.
double slipOfTips(const record::Recording& recording, Ground ground);

/// Smallest value at which `sticks` holds, between `low` and `high`, to 2^-steps of the interval.
double bisect(double low, double high, int steps, const std::function<bool(double)>& sticks);

} // namespace supercircle::validation
