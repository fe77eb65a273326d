#pragma once
// Characteristic scales of effects on the bodies of a free scene.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/natural_units.h"

namespace supercircle::replay {

struct FreeScales {
    double length = 0.1;   ///< m, farthest point of a moving body from its nearest joint; of bodies without shape how
                           ///< far springs or the machine move them
    double torque = 1e-2;  ///< N m, weight of all moving bodies times half of that length
    double spin = 10.0;    ///< rad/s, sqrt(g / length) or of the springs; without both the fastest released body's
    double fastest = 10.0; ///< rad/s, of a released body if that is larger
    double force = 0.1;    ///< N, torque / length
    double way = 0.1;      ///< m, largest elongation of springs, or the travel of the machine
    double twist = 1.0;    ///< rad, largest of turning springs
    bool shaped = true;    ///< moving bodies have a shape that air could hold back
    bool turns = true;     ///< there are bearings
    bool slides = false;   ///< there are guides, without stated friction
    bool springs = false, turningSprings = false;
};

/// Scales of the scene with its nominal parameters; the defaults where it cannot be simulated.
FreeScales freeScales(const experiment::Experiment& experiment);

/// Natural units of any experiment: those of its specimens, or of the bodies of its free scene, whose reference is a
/// pendulum with the defaults above.
experiment::NaturalUnits naturalUnits(const experiment::Experiment& experiment);

} // namespace supercircle::replay
