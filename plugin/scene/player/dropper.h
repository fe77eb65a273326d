#pragma once
// Shells that fall at random places and angles (paper, Methods): where the next ones enter.

#include "plugin/api/include/supercircle/shells.hpp"
#include "plugin/scene/loader/scene.h"
#include "plugin/scene/player/random.h"

#include <string>
#include <vector>

namespace supercircle::player {

/// Puts `count` more shells of `drop` into the world, side by side in rows above the pile, and appends their handles.
/// @return empty, or why it could not be done
std::string dropBatch(Shells& shells, const scene::Drop& drop, int count, Random& random,
                      std::vector<ShellHandle>& made);

/// Highest point of the shells' surfaces, m; minus infinity without shells.
double pileTop(const step::World& world);

/// Fastest point of any shell in the last step, m/s.
double fastest(const step::World& world);

} // namespace supercircle::player
