#pragma once
// Friction from an observed switch: shells of several opening angles were pushed over each other (or over a cylinder),
// shallow ones snapped smoothly, deep ones stuck and unfolded abruptly (paper, figure 2(c)).
//
// For an opening angle there is a coefficient mu* below which the snap is smooth; it falls as the angle grows. A smooth
// snap at an angle says mu < mu*(angle), an abrupt one mu > mu*(angle): the deepest smooth and the shallowest abrupt
// shell bound mu from both sides. mu* comes from simulations by bisection; an uncertain angle widens the interval.

#include "plugin/recording/table/result.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::calibration {

enum class Snap { Smooth, Abrupt };

/// A shell that was tried.
struct Trial {
    double phiBar = 0.0; ///< opening angle / 2 pi
    Snap outcome = Snap::Smooth;
};

/// Simulates a trial; empty if it could not be, or was neither.
using Simulate = std::function<std::optional<Snap>(double phiBar, double mu)>;

struct SwitchSettings {
    double angleUncertainty = 0.0;      ///< half-width of phiBar
    double tolerance = 0.002;           ///< of mu*
    double most = 2.0;                  ///< largest coefficient looked at
    double least = 0.5, deepest = 0.99; ///< opening angles that can be simulated
};

/// Where a shell of an opening angle switches.
struct Critical {
    double phiBar = 0.0;
    double below = 0.0; ///< the snap is smooth here ...
    double above = 0.0; ///< ... and abrupt here; infinite if it is smooth up to SwitchSettings::most
    int simulations = 0;
};

struct SwitchResult {
    double low = 0.0, high = 0.0;                   ///< interval of the coefficient; high may be infinite
    std::optional<Critical> fromAbrupt, fromSmooth; ///< what bounds it from below and from above
};

/// mu* of one opening angle by bisection, or why not.
[[nodiscard]] record::Result<Critical> criticalFriction(double phiBar, const Simulate& simulate,
                                                        const SwitchSettings& settings);

/// The interval, or why there is none: trials that contradict each other, simulations that end in nothing.
[[nodiscard]] record::Result<SwitchResult> frictionFromSwitch(const std::vector<Trial>& trials,
                                                              const Simulate& simulate, const SwitchSettings& settings);

} // namespace supercircle::calibration
