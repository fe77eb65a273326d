#pragma once
// Energy that a frame of an island ends with and that nobody gave: the alarm on all that corrects positions (private to
// step/).
//
// Gross amounts say little: what closes a gap in one step and stops in the next brings in and takes out the same energy
// many times a frame (decision 0179). So the frame is judged as a whole. Its gain is what friction, impacts, damping,
// the integration and corrections took together, where that is negative.

#include "supercircle/step/world.h"

namespace supercircle::step {

/// Parts of what moved that a frame may gain, and that overlaps may bring in. Twice as much hides a gain of 6 % a
/// second, and of 60 % where overlaps part; half of it is met in no frame of ordinary play, but in a few of a million
/// random calls.
constexpr double kGainShare = 1e-3, kGainShareOfOverlaps = 1e-2;

/// What moved, bent and was passed on in a frame that began with the balance `before` and has come to `world`, J.
[[nodiscard]] double movedEnergy(const EnergyBalance& before, const World& world);

/// Gain of a frame that began with the balance `before` and ended in `world`, J; 0: none.
[[nodiscard]] double gainedEnergy(const EnergyBalance& before, const World& world);

/// Gain beyond which a frame of `dt` s raises the alarm, J: a thousandth of what moved, bent and was passed on, a
/// hundredth where overlaps part, and for each row that closes a gap (gap_closing.h) the motion of its shell at that
/// speed and what its force does meanwhile.
[[nodiscard]] double boundOfGain(const EnergyBalance& before, const World& world, const Settings& settings, double dt);

} // namespace supercircle::step
