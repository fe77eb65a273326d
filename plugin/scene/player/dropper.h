#pragma once
// Creates shells at random positions and angles above the pile, from where they fall (paper, Methods).

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/scene/loader/scene.h"
#include "plugin/scene/player/random.h"

#include <string>
#include <vector>

namespace supercircle::player {

/// Creates `count` shells of `drop`, side by side in rows above the pile, and appends their handles. After a
/// failure those already made stay.
Status dropBatch(Shells& shells, const scene::Drop& drop, int count, Random& random, std::vector<ShellHandle>& made);

/// Highest point of the shells' surfaces, m; minus infinity without shells.
double pileTop(const step::World& world);

/// Fastest point of any shell in the last step, m/s.
double fastest(const step::World& world);

} // namespace supercircle::player
