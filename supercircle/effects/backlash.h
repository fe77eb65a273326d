#pragma once
// Backlash of a drive: the motion of the crosshead for a given motion of the drive.

#include <vector>

namespace supercircle::effects {

/// A piecewise linear motion.
struct DriveMotion {
    std::vector<double> time;         ///< s, increasing
    std::vector<double> displacement; ///< m
};

/// Motion of the crosshead behind a drive with a backlash of `width` (m), taken up in the positive direction at the
/// start. The crosshead stays until the drive has crossed the backlash: x = clamp(x, drive, drive + width).
DriveMotion motionBehindBacklash(const DriveMotion& drive, double width);

} // namespace supercircle::effects
