#pragma once
// The shells' own damping: a bending moment tau B dkappa/dt beside the elastic one (Kelvin-Voigt),
// with tau = 2 zeta / omega_1 for a damping ratio zeta of the first mode, as the rod is held. A mode of n times its
// frequency has n times the ratio: what no step resolves does not ring.

#include "supercircle/step/world.h"

namespace supercircle::step {

/// Circular frequency of the first mode of a rod about its present shape, as it is held, rad/s; 0: it cannot swing.
[[nodiscard]] double firstFrequency(const Rod& rod);
/// Brings Rod::dampingTime up to date where the ratio, the rod or its holds have changed.
void refreshDamping(World& world, const Settings& settings);

} // namespace supercircle::step
