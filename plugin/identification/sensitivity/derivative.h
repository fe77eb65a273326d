#pragma once
// A derivative from four simulations around a point (private to sensitivity/).

#include "plugin/identification/sensitivity/batch.h"

namespace supercircle::sensitivity {

/// Computational noise of one run.
struct RunNoise {
    Eigen::VectorXd force;                       ///< per row, N
    double forceRms = 0.0;                       ///< N
    double markerRms = 0.0;                      ///< m
    Eigen::VectorXd landmarks;                   ///< per landmark
    Eigen::Array<bool, Eigen::Dynamic, 1> quiet; ///< rows away from jumps
};

/// Simulations around the centre. One-sided: only `whole` and `half` of the possible side.
struct Probes {
    double step = 0.0;
    int side = 0; ///< 0: both; +1, -1: one-sided
    SimulatedValues wholePlus, halfPlus, wholeMinus, halfMinus;
};

/// A derivative and its quality.
struct Derivative {
    Quality quality;
    Eigen::VectorXd force, markers, landmarks, landmarkError;
    Eigen::Array<bool, Eigen::Dynamic, 1> usable;
    double forceDisagreement = 0.0; ///< relative disagreement, noise included: for the choice of the step
};

/// @param base simulation at the centre, with landmarks
Derivative derivativeOf(const Probes& probes, const SimulatedValues& base, const experiment::Readings& readings,
                        const RunNoise& noise, const SensitivitySettings& settings,
                        const experiment::NaturalUnits& units);

/// False in rows from 1.5 samples before any jump of these curves to the end of the oscillation after it.
Eigen::Array<bool, Eigen::Dynamic, 1> awayFromJumps(const std::vector<const SimulatedValues*>& curves,
                                                    const Landmarks& base, const std::vector<double>& time,
                                                    const experiment::NaturalUnits& units);

/// Computational noise from values at equally spaced points of the columns, the first at the centre.
RunNoise noiseOf(const std::vector<const SimulatedValues*>& curves, const Landmarks& base,
                 const std::vector<double>& time, const experiment::NaturalUnits& units);

} // namespace supercircle::sensitivity
