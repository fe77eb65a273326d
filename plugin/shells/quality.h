#pragma once
// Settings of the stepper for each quality.

#include "plugin/include/supercircle/shells.hpp"
#include "supercircle/step/world.h"

namespace supercircle {

/// `threads` is kept as it is.
step::Settings settingsFor(Quality quality, int threads);
/// Which of them these are (a budget per frame: Game); restored snapshots bring settings along.
Quality qualityOf(const step::Settings& settings);

} // namespace supercircle
