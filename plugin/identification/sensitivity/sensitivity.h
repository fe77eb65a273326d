#pragma once
// Derivatives of simulated readings with respect to named scalars: one Jacobian per run for the curve, one for the
// landmarks, with their errors. All simulations are independent; results do not depend on the number of threads.
// Each derivative is taken with a step and with half of it:
// - the step is stretched until half of it changes the readings by three times the computational noise
// (SensitivitySettings::smallestSignal), at most to the column's scale; otherwise the column is `belowNoise`;
// - it is cut where both derivatives disagree; `twoStepError` is the remaining disagreement;
// - the one with the smaller total error is kept.
// Near a jump rows are not `usable`, and the landmarks apply.

#include "plugin/identification/sensitivity/landmarks.h"
#include "plugin/identification/sensitivity/model.h"

#include <Eigen/Core>
#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace supercircle::sensitivity {

/// Step and quality of a derivative of one run with respect to one column.
struct Quality {
    double step = 0.0;              ///< in units of the column; two-sided unless `oneSided`
    bool oneSided = false;          ///< the other side cannot be simulated
    double signal = 0.0;            ///< change of the force over half a step, in units of computational noise, rms
    double markerSignal = 0.0;      ///< the same for the markers
    double twoStepError = 0.0;      ///< rms difference of the two derivatives beyond noise, relative
    double noiseError = 0.0;        ///< rms error of the derivative from computational noise, relative
    bool belowNoise = false;        ///< force: signal below SensitivitySettings::smallestSignal at `step`
    bool markersBelowNoise = false; ///< the same for the markers
    double jumpShift = 0.0;         ///< samples, largest shift of a jump over the steps
    bool changesJumps = false;      ///< a jump shifts by more than a sample, or appears or vanishes
    std::string failure;            ///< error of failed simulations; then the derivative is zero and no row is usable
};

using Mask = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Derivatives of one run. Columns of all matrices as in Sensitivities::columns.
struct RunSensitivity {
    replay::Simulated base;           ///< simulation at the columns' values
    Eigen::MatrixXd force;            ///< N per unit of the column, rows of base.readings x columns
    Mask usable;                      ///< same shape: away from jumps, and both steps agree
    Eigen::MatrixXd markers;          ///< m per unit, rows as in SimulatedValues::markers
    Landmarks landmarks;              ///< of base
    Eigen::MatrixXd landmarkJacobian; ///< landmarks x columns; NaN if a simulation has no such landmark
    Eigen::MatrixXd landmarkError;    ///< same shape: noise and disagreement of both steps
    Eigen::VectorXd forceNoise;       ///< N, computational noise of the force per row (moving rms)
    double forceNoiseRms = 0.0;       ///< N, over all rows away from jumps
    double markerNoiseRms = 0.0;      ///< m
    Eigen::VectorXd landmarkNoise;    ///< computational noise of each landmark
    std::vector<Quality> quality;     ///< per column
    /// Whether the column is visible in the force or the markers.
    [[nodiscard]] bool isDetectable(std::size_t column) const {
        return quality[column].failure.empty() && !(quality[column].belowNoise && quality[column].markersBelowNoise);
    }
};

struct Sensitivities {
    std::vector<Column> columns;
    std::vector<RunSensitivity> runs;
    std::size_t simulations = 0;
    double cpuSeconds = 0.0; ///< s, of all simulations
    bool stopped = false;    ///< interrupted: results are incomplete
    std::string failure;     ///< why the experiment cannot be simulated at the columns' values
};

struct SensitivitySettings {
    int jobs = 1;                                  ///< simulations at a time
    const std::atomic<bool>* interrupt = nullptr;  ///< becomes true: stop
    std::function<void(double fraction)> progress; ///< called from any thread, never concurrently
    double firstStep = 0.25;                       ///< first step, share of the scale
    double smallestSignal = 3.0;                   ///< required signal of half a step, in computational noise
    double disagreement = 0.1;                     ///< largest disagreement before the step is cut
    int rounds = 3;                                ///< largest number of steps per column and run, at least 1
};

/// All derivatives of the model. `experiment` gives drive, sampling and markers of its runs.
Sensitivities differentiate(const Model& model, const experiment::Experiment& experiment,
                            const SensitivitySettings& settings);

/// Cosines between the effects of columns on the force, over all runs (scaled by peak force) and rows usable for both;
/// 0 for columns below noise. 1 or -1: one can compensate the other.
Eigen::MatrixXd similarity(const Sensitivities& sensitivities);

} // namespace supercircle::sensitivity
