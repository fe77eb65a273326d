#pragma once
// Friction from an observed switch. Shells of several opening angles are pushed over each other (or over a cylinder):
// shallow ones snap smoothly, deep ones stick and unfold abruptly (paper, figure 2(c)).
//
// For an opening angle there is a coefficient mu* below which the snap is smooth; it falls with the angle. A smooth
// snap means mu < mu*(angle), an abrupt one mu > mu*(angle). The deepest smooth and the shallowest abrupt shell
// therefore bound mu. mu* is found by simulation and bisection; an uncertain angle widens the interval.

#include "supercircle/support/result.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::calibration {

enum class Snap { Smooth, Abrupt };

/// An observed shell.
struct Trial {
    double phiBar = 0.0; ///< opening angle / 2 pi
    Snap outcome = Snap::Smooth;
};

/// Simulates a trial; empty if that fails or the snap is neither.
using Simulate = std::function<std::optional<Snap>(double phiBar, double mu)>;

struct SwitchSettings {
    double angleUncertainty = 0.0;           ///< half-width of phiBar
    double tolerance = 0.002;                ///< of mu*
    double largest = 2.0;                    ///< largest coefficient considered
    double shallowest = 0.5, deepest = 0.99; ///< opening angles that can be simulated
};

/// Critical coefficient of one opening angle.
struct CriticalFriction {
    double phiBar = 0.0;
    double below = 0.0; ///< the snap is smooth here ...
    double above = 0.0; ///< ... and abrupt here; infinite if it is smooth up to SwitchSettings::largest
    int simulations = 0;
};

struct SwitchResult {
    double low = 0.0, high = 0.0;                           ///< interval of the coefficient; high may be infinite
    std::optional<CriticalFriction> fromAbrupt, fromSmooth; ///< the lower and the upper bound
};

/// mu* of one opening angle by bisection, or an error message.
[[nodiscard]] Result<CriticalFriction> criticalFriction(double phiBar, const Simulate& simulate,
                                                        const SwitchSettings& settings);

/// The interval, or an error message: contradictory trials, or failed simulations.
[[nodiscard]] Result<SwitchResult> frictionFromSwitch(const std::vector<Trial>& trials, const Simulate& simulate,
                                                      const SwitchSettings& settings);

} // namespace supercircle::calibration
