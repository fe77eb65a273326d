#pragma once
// One derivative from four probes around a point (private to sensitivity/).

#include "plugin/identification/sensitivity/batch.h"

namespace supercircle::sensitivity {

/// The solver's roughness in one run.
struct RunNoise {
    Eigen::VectorXd force;                       ///< per row, N
    double forceRms = 0.0;                       ///< N
    double markerRms = 0.0;                      ///< m
    Eigen::VectorXd landmarks;                   ///< per landmark
    Eigen::Array<bool, Eigen::Dynamic, 1> quiet; ///< rows away from jumps of the noise probes
};

/// Simulations around the centre. One-sided: only `whole` and `half` of the side that can be simulated.
struct Probes {
    double step = 0.0;
    int side = 0; ///< 0: both; +1, -1: one-sided
    Observed wholePlus, halfPlus, wholeMinus, halfMinus;
};

/// A derivative and its quality.
struct Derivative {
    Quality quality;
    Eigen::VectorXd force, markers, landmarks, landmarkError;
    Eigen::Array<bool, Eigen::Dynamic, 1> usable;
    double forceDisagreement = 0.0; ///< relative, noise included: for the choice of the step
};

/// @param base of the centre, landmarks included
Derivative derivativeOf(const Probes& probes, const Observed& base, const experiment::Readings& readings,
                        const RunNoise& noise, const Settings& settings);

/// Rows within a sample and a half ahead of and 0.3 s behind any jump of these curves, which belong together; those
/// are false.
Eigen::Array<bool, Eigen::Dynamic, 1> awayFromJumps(const std::vector<const Observed*>& curves, const Landmarks& base,
                                                    const std::vector<double>& time);

/// From the values at equally spaced points of the columns (the first is the centre).
RunNoise noiseOf(const std::vector<const Observed*>& curves, const Landmarks& base, const std::vector<double>& time);

} // namespace supercircle::sensitivity
