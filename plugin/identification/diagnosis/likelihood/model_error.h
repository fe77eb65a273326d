#pragma once
// Model error of the simulation in each row, and rows that are excluded.
// - Discretisation: the error falls with the third power of the arc length (rod/elasticity.h). Richardson
// extrapolation (L. F. Richardson, Phil. Trans. R. Soc. A 210 (1911) 307) removes it; a quarter stays as model error,
// all of it where it changes quickly. Beside it stand contact positions known to micrometres and a share of the peak
// force (decision 0072).
// - Excluded are rows around snaps and abrupt reversals, rows near a contact at which the force is present immediately,
// and markers after a release (decision 0074). The time of a jump is a row of its own (jumps.h).

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/likelihood/jumps.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/diagnosis/noise.h"

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// Lengths and times are those of the reference specimen.
struct LikelihoodSettings {
    double contactPosition = 3e-6; ///< m, accuracy of contact positions
    double shareOfPeak =
        4e-4; ///< accuracy of a corrected simulation, share of the peak force, with the model's correlation time
    double scale = 1e-3; ///< accuracy common to a whole run, share of the force
    /// Error of the fine simulation per difference of the finer one to it: 1 / (1 - (21/41)^3).
    double refinement = 1.155;
    double uncorrected = 0.25;       ///< share of the correction that stays as model error
    bool discretised = true;         ///< simulations have an error of discretisation: those of bodies alone have none
    double repeatFactor = 1.0;       ///< factor of all model errors: forRepeats()
    double markerAccuracy = 1.5e-5;  ///< m, accuracy of a simulated marker in one row
    double markerShift = 5e-6;       ///< m, accuracy common to the markers of one stroke
    double clockError = 0.1;         ///< sampling intervals by which the clocks of reading and drive may differ
    double snapPositionError = 1e-4; ///< m, accuracy of the position after a snap
    double releaseOscillation = 0.5; ///< s, duration of oscillation after a release: markers are excluded
    double releasedShare = 0.01;     ///< share of the peak force below which a specimen is released
    double contactAccuracy = 2e-5;   ///< m, accuracy of a contact at which the force is present immediately
    double reversalRows = 1.5;       ///< rows excluded on either side of an abrupt reversal, or of a jump there
    double abruptReversal = 0.25;    ///< change of speed, share of the fastest, that counts as abrupt
    double snapBefore = 0.1;         ///< s excluded before a snap
    double snapAfter = 0.3;          ///< s excluded after a snap
    double snapShare = 0.15;         ///< smallest snap, share of the force range within two rows
    double jumpPositionError = 5e-3; ///< accuracy of a simulated jump's position, share of the travel, common to a run
    double jumpNoise = 6.0;          ///< smallest recorded jump or snap, sigma of the noise
    double jumpReach = 0.2;          ///< largest distance of one event in two curves, share of a stroke

    /// Settings for each of n repeats. Their model error is the same, so repeats do not average it. Errors sqrt(n)
    /// times larger in each, taken as independent, leave the common error as large as in one run.
    [[nodiscard]] LikelihoodSettings forRepeats(std::size_t n) const;
    /// The same for a set-up.
    [[nodiscard]] LikelihoodSettings in(const experiment::NaturalUnits& units) const;
    /// The same for recordings. A driven load has no position. The rows of a table are read at rest, without a clock,
    /// and too far apart to tell a jump from a slope.
    [[nodiscard]] LikelihoodSettings of(const RecordedData& data) const;
};

/// Standard deviation of the simulated force in row k from the accuracy of contact positions, N.
/// @param travel of the crosshead from row to row, m
double positionError(const Eigen::VectorXd& force, Eigen::Index k, double travel, const LikelihoodSettings& settings);

/// Model error in each row, and which rows are excluded.
struct ModelError {
    Eigen::VectorXd force;        ///< N, standard deviation; infinite: excluded
    Eigen::VectorXd markers;      ///< m, standard deviation with noise; infinite: excluded
    Eigen::VectorXd correction;   ///< N, discretisation correction of a fine simulation's force
    double correlationTime = 1.0; ///< s, of the error of the force
    std::vector<double> snaps;    ///< s, times of snaps
};
ModelError modelErrorOf(const RecordedRun& run, const Noise& noise, const Response& fine, const Response& finer,
                        double peakForce, const LikelihoodSettings& settings);

/// Interval that is masked if one jump has two different times, s.
std::pair<double, double> maskedRange(double t0, double t1, const LikelihoodSettings& settings);

/// Jumps of a simulation, from half the size of recorded ones on: a partner near the threshold must not come and go.
std::vector<replay::Landmark> jumpsOf(const RecordedRun& run, const Response& simulated,
                                      const LikelihoodSettings& settings);

} // namespace supercircle::diagnosis
