#pragma once
// Friction from measured force curves: the coefficient is fitted to recorded runs together with everything else the
// description states with an interval, which it may not leave.
//
// Model, noise and misfit are those of a diagnosis without effects; only the coefficient's own interval is widened to
// [0, most]. Its uncertainty is the profile likelihood of the linearised fit: for every value of the coefficient the
// other parameters take their best values inside their intervals, and the 90 % interval is where the misfit rises by
// less than 2.706 times the misfit per row (where that exceeds one the model is not complete, and the interval grows
// with it). Source: S. S. Wilks, Ann. Math. Stat. 9 (1938) 60; R. T. Birge, Phys. Rev. 40 (1932) 207 for the factor.

#include "plugin/recording/experiment/experiment.h"

#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::calibration {

struct CurveSettings {
    double most = 2.0; ///< largest coefficient looked at
    int jobs = 1;
    const std::atomic<bool>* interrupt = nullptr;
    std::function<void(double fraction, const std::string& stage)> progress;
};

struct CurveResult {
    std::string failure; ///< empty unless it could not be done
    bool stopped = false;
    double friction = 0.0;
    double low = 0.0, high = 0.0;                       ///< 90 % interval
    double misfitPerRow = 0.0;                          ///< 1: the model explains the recordings to within noise
    double noise = 0.0;                                 ///< N, of the sensor
    std::vector<std::pair<std::string, double>> others; ///< fitted values of the other parameters
    std::size_t simulations = 0;
};

/// Fits the friction coefficient to all runs of an experiment.
[[nodiscard]] CurveResult frictionFromCurve(const experiment::Experiment& experiment, const CurveSettings& settings);

} // namespace supercircle::calibration
