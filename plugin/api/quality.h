#pragma once
// Settings of the stepper for each quality.

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/world.h"

namespace supercircle {

/// Threads and sleep stay as in `before`.
step::Settings settingsFor(Quality quality, const step::Settings& before);
/// The quality that these settings belong to: only Game has Settings::cull.
Quality qualityOf(const step::Settings& settings);

} // namespace supercircle
