#pragma once
// By what the effects on the bodies of a free scene are measured.

#include "plugin/recording/experiment/experiment.h"

namespace supercircle::replay {

struct FreeScales {
    double length = 0.1;  ///< farthest point of a moving body from the nearest of its joints, m
    double torque = 1e-2; ///< weight of all moving bodies times half of that length, N m
    double spin = 10.0;   ///< sqrt(g / length), rad/s
};

/// Of the scene with its nominal parameters; the defaults where it cannot be played.
FreeScales freeScales(const experiment::Experiment& experiment);

} // namespace supercircle::replay
