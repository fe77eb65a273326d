#pragma once
// Settings of the stepper for each quality.

#include "plugin/include/supercircle/shells.hpp"
#include "supercircle/step/world.h"

namespace supercircle {

/// Threads and sleep are kept as they were `before`.
step::Settings settingsFor(Quality quality, const step::Settings& before);
/// Which of them these are (a budget per frame: Game); restored snapshots bring settings along.
Quality qualityOf(const step::Settings& settings);

} // namespace supercircle
