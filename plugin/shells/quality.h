#pragma once
// Settings of the stepper for each quality.

#include "plugin/include/supercircle/shells.hpp"
#include "supercircle/step/world.h"

namespace supercircle {

step::Settings settingsFor(Quality quality, int threads);

} // namespace supercircle
