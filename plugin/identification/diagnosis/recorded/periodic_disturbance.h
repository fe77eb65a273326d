#pragma once
// Periodic disturbance of the readings that is not caused by the specimen (pumps, mains, building vibration).
//
// It appears in dwell intervals longer than two of its periods. With shorter ones it would count as noise, so it is
// also searched in the baseline residual of whole runs. Missing physics looks like noise of long correlation there: it
// follows the drive, not the clock (decision 0071).

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/recorded/dwell_intervals.h"

#include <cstddef>
#include <vector>

namespace supercircle::diagnosis {

/// White plus AR(1) noise.
struct CorrelatedNoise {
    double white = 0.0, correlated = 0.0; ///< N, standard deviations
    double correlationTime = 0.25;        ///< s, of the AR(1) part
};

/// A sine with one period in all runs and amplitude and phase of each run.
struct PeriodicDisturbance {
    double period = 0.0;                    ///< s; 0: none
    std::vector<double> cosine, sine;       ///< N, of each run, over its own time
    double explained = 0.0;                 ///< decrease of chi-squared
    [[nodiscard]] double amplitude() const; ///< N, root mean square over the runs with a phase
    [[nodiscard]] double at(std::size_t run, double time) const;
    /// The recordings without the disturbance.
    [[nodiscard]] RecordedData removedFrom(const RecordedData& data) const;
};

/// Log likelihood gain required for a disturbance: amplitude and phase of each run, and one of some hundred periods.
double disturbancePenalty(const RecordedData& data);

/// The sine that explains most in the dwell intervals, beside the noise and relaxations of 0.3, 1 and 3 s.
/// @param periods in the dwell intervals of one run, at least
PeriodicDisturbance strongestDisturbance(const RecordedData& data, const std::vector<DwellInterval>& dwells,
                                         const CorrelatedNoise& noise, double periods);

/// The sine that dominates the residual of whole runs, if there is no doubt (period 0: none). The longest run has four
/// periods, runs of two or more periods have amplitudes within a factor of two, and half of chi-squared is due to the
/// sine. The likelihood gain over noise alone exceeds disturbancePenalty().
/// @param residual per run, recorded minus simulated force, N; not finite in rows that do not count
PeriodicDisturbance findDisturbanceInResidual(const RecordedData& data, const std::vector<Eigen::VectorXd>& left);

} // namespace supercircle::diagnosis
