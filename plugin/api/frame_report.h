#pragma once
// What a frame says about itself (private to plugin/api).

#include "plugin/api/include/supercircle/shells.hpp"
#include "supercircle/step/stepper.h"

namespace supercircle {

/// What the report and its line compare with.
struct FrameStart {
    step::Counters counters;
    step::InjectedEnergy injected;
    explicit FrameStart(const step::World& world) : counters(world.counters), injected(world.energyBalance.injected) {}
};

/// Fills in numbers of the frame of `dt` s, and FrameReport::why. `events` are those of the frame.
void complete(FrameReport& report, const step::World& world, const step::Settings& settings, const FrameStart& start,
              double dt, const FrameEvents& events);

} // namespace supercircle
