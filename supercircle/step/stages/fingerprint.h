#pragma once
// Fingerprints of a world's state (private to step/), for the assertions that a trial or a sleeper changes nothing.

#include "supercircle/step/world.h"

namespace supercircle::step {

/// Of all bits that decide the future of rods, bodies, joints, contacts, energies and counters (FNV-1a).
[[nodiscard]] std::uint64_t fingerprint(const World& world);
/// Of the motion of quarantined and sleeping rods.
[[nodiscard]] std::uint64_t fingerprintOfFrozen(const World& world);

} // namespace supercircle::step
