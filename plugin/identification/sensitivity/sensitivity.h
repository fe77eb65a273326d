#pragma once
// Derivatives of simulated readings with respect to named scalars: one Jacobian per run for the curve, one for the
// landmarks, and how far either can be trusted.
//
// All columns of all runs are one batch of independent simulations, spread over threads; results do not depend on how
// many there are. Each derivative is taken twice, with a step and with half of it:
// - the roughness of the solver (noise.h) is measured first; a step is stretched until half of it changes the readings
//   by at least three times that (Settings::leastSignal), but never beyond the column's scale. Where that is not
//   enough, the column is `weak`: what it does is lost in the solver's noise;
// - where the two derivatives disagree and the signal allows it, the step is cut. What is left of the disagreement is
//   in `twoStepError`;
// - of the two the one with the smaller sum of roughness and disagreement is kept.
// Near a jump a pointwise derivative says where the jump goes, not how the curve changes: those rows are not usable()
// and the landmarks' Jacobian takes over. A column that moves a jump by more than a sample, or makes or removes one,
// says so.

#include "plugin/identification/sensitivity/landmarks.h"
#include "plugin/identification/sensitivity/model.h"

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace supercircle::sensitivity {

/// How the derivative of one run with respect to one column was taken, and how good it is.
struct Quality {
    double step = 0.0;         ///< of the column, its unit; two-sided unless `oneSided`
    bool oneSided = false;     ///< the other side cannot be simulated
    double signal = 0.0;       ///< change of the force over half of the step in units of the solver's noise, rms
    double markerSignal = 0.0; ///< the same of the markers
    double twoStepError = 0.0; ///< rms difference of the two derivatives beyond noise, share of the derivative's rms
    double noiseError = 0.0;   ///< rms error of the derivative from the solver's noise, share of the same
    bool weak = false;         ///< force: signal below Settings::leastSignal at `step`
    bool markersWeak = false;  ///< the same of the markers
    double jumpShift = 0.0;    ///< largest movement of a jump over the steps, samples
    bool reorders = false;     ///< a jump moves by more than a sample, or their number changes
    std::string failure;       ///< simulations that failed; then the derivative is zero and nothing is usable
};

using Mask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// One run. Columns of all matrices as Sensitivities::columns.
struct RunSensitivity {
    replay::Simulated base;           ///< at the columns' values
    Eigen::MatrixXd force;            ///< rows of base.readings x columns, N per unit of the column
    Mask usable;                      ///< the same shape: away from jumps, two steps agree
    Eigen::MatrixXd markers;          ///< x of marker 0 over time, then y, then marker 1, ...: m per unit
    Landmarks landmarks;              ///< of base
    Eigen::MatrixXd landmarkJacobian; ///< landmarks x columns; NaN where a probe has no such landmark
    Eigen::MatrixXd landmarkError;    ///< the same: noise and disagreement of the two steps
    Eigen::VectorXd forceNoise;       ///< roughness of the force, per row (a moving rms), N
    double forceNoiseRms = 0.0;       ///< over all rows away from jumps, N
    double markerNoiseRms = 0.0;      ///< m
    Eigen::VectorXd landmarkNoise;    ///< roughness of each landmark
    std::vector<Quality> quality;     ///< per column
    /// Whether the column is seen at all, in the force or in the markers.
    [[nodiscard]] bool good(std::size_t column) const {
        return quality[column].failure.empty() && !(quality[column].weak && quality[column].markersWeak);
    }
};

struct Sensitivities {
    std::vector<Column> columns;
    std::vector<RunSensitivity> runs;
    std::size_t simulations = 0;
    double cpuSeconds = 0.0; ///< of all of them
    bool stopped = false;    ///< interrupted: the rest is not meaningful
    std::string failure;     ///< the experiment cannot be simulated at the columns' values
};

struct Settings {
    int jobs = 1;                                  ///< simulations at a time
    const std::atomic<bool>* interrupt = nullptr;  ///< becomes true: stop
    std::function<void(double fraction)> progress; ///< called from any thread, one at a time
    double firstStep = 0.25;                       ///< share of the scale
    double leastSignal = 3.0;                      ///< of half a step, in units of the solver's noise
    double disagreement = 0.1;                     ///< of the two derivatives, above it the step is cut
    int rounds = 3;                                ///< steps tried per column and run, at least 1
};

/// All derivatives of the model. `experiment` gives drive, sampling and marker layout of its runs.
Sensitivities differentiate(const Model& model, const experiment::Experiment& experiment, const Settings& settings);

/// Cosines of the angles between the columns' effects on the force, over all runs (each in units of its peak
/// force) and the rows usable for both; 0 where a column is weak. 1 or -1: what one does the other can undo.
Eigen::MatrixXd similarity(const Sensitivities& sensitivities);

} // namespace supercircle::sensitivity
