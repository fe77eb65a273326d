#pragma once
// Settings of the stepper for each quality.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/world.h"

namespace supercircle {

/// Threads and sleep are kept as they were `before`.
step::Settings settingsFor(Quality quality, const step::Settings& before);
/// Which of them these are, told by Settings::prune, which only Game has; restored snapshots bring settings along.
Quality qualityOf(const step::Settings& settings);

} // namespace supercircle
