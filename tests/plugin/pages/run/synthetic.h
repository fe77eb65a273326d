#pragma once
// Synthetic recordings with the structure of real ones, for tests of pictures and files; they contain no physics.

#include "plugin/recording/table/recording.h"

namespace supercircle::test {

/// `shells` open shells that fall into a container, are squeezed by a plate and released, in `frames` frames and `rows`
/// samples, with snap-fits, contacts and energies.
[[nodiscard]] record::Recording squeezedStack(int shells = 30, int frames = 240, int rows = 4000, int cycles = 1);

/// One closed ring that rolls on a floor: no crosshead, no force.
[[nodiscard]] record::Recording rollingRing(int frames = 20);

} // namespace supercircle::test
