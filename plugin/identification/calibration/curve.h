#pragma once
// Friction from measured force curves: the coefficient is fitted to recorded runs together with all stated parameters,
// inside their intervals.
//
// Model, noise and likelihood are those of a diagnosis without effects; only the friction interval is widened to [0,
// largest]. The 90 % interval is a profile likelihood of the linearised fit: chi-squared rises by 2.706, times the mean
// squared residual where that exceeds one. Source: S. S. Wilks, Ann. Math. Stat. 9 (1938) 60; R. T. Birge, Phys. Rev.
// 40 (1932) 207 for the factor.

#include "plugin/recording/experiment/experiment.h"

#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::calibration {

struct CurveSettings {
    double largest = 2.0; ///< largest coefficient considered
    int jobs = 1;
    const std::atomic<bool>* interrupt = nullptr;
    std::function<void(double fraction, const std::string& stage)> progress;
};

struct CurveResult {
    std::string failure; ///< why there is no result; empty: there is one
    bool stopped = false;
    double friction = 0.0;
    double low = 0.0, high = 0.0;                       ///< 90 % interval
    double chiSquaredPerReading = 0.0;                  ///< 1: the model explains the recordings to within noise
    double noise = 0.0;                                 ///< N, of the sensor
    std::vector<std::pair<std::string, double>> others; ///< fitted values of the other parameters
    std::size_t simulations = 0;
};

/// Fits the friction coefficient to all runs of an experiment.
[[nodiscard]] CurveResult frictionFromCurve(const experiment::Experiment& experiment, const CurveSettings& settings);

} // namespace supercircle::calibration
