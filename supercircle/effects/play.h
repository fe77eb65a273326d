#pragma once
// Play in a drive: which way the head goes when the drive is told where to go.

#include <vector>

namespace supercircle::effects {

/// A piecewise linear motion.
struct Motion {
    std::vector<double> time;         ///< s, increasing
    std::vector<double> displacement; ///< m
};

/// The head behind a drive with a play of `width` (m), taken up in the positive direction at the start: the head stays
/// where it is until the drive has crossed the play, x = clamp(x, drive, drive + width).
Motion behindPlay(const Motion& drive, double width);

} // namespace supercircle::effects
