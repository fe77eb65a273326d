#pragma once
// Windows in which a misfit is tested: dyadic in time in each run and stroke (half overlapping), dyadic in displacement
// per phase over all runs, loading against unloading, whole runs, each marker coordinate and further channel over time,
// and each jump.

#include "plugin/identification/diagnosis/likelihood.h"

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// The significant statistic: a shifted mean, excess energy, or the signature of an effect in all readings that appears
/// here.
enum class StatisticKind : std::uint8_t { Shift, Energy, Signature };

struct ResidualWindow {
    std::string run;                     ///< name, or "all"
    std::string phase;                   ///< loading, unloading, hold, all
    std::string axis;                    ///< time, displacement, contrast (loading against unloading)
    std::string channel;                 ///< RecordedData::channel, a further one, or the marker's name with _x, _y
    double timeFrom = 0.0, timeTo = 0.0; ///< s (over all runs: earliest and latest)
    double displacementFrom = 0.0, displacementTo = 0.0; ///< m
    double arcFraction = -1.0;                           ///< of a marker, -1: none
    double z = 0.0;                                      ///< standardised statistic
    StatisticKind kind = StatisticKind::Shift;
    double p = 1.0; ///< family-wise
    [[nodiscard]] bool ofMarker() const { return arcFraction >= 0.0; }
};

/// A window and its rows in the stacked readings.
struct WindowRows {
    ResidualWindow window;
    std::vector<Eigen::Index> rows; ///< in the stack, increasing
    Eigen::VectorXd sign;           ///< of each row, for opposite shifts; empty: all +1
};

/// All windows with at least four rows that count, and those of jumps.
std::vector<WindowRows> windowsOf(const Likelihood& likelihood);

/// Sets times, displacements and phase of a window from rows [from, to) of a run's force.
void setSpan(const RecordedRun& run, Eigen::Index from, Eigen::Index to, ResidualWindow& window);

} // namespace supercircle::diagnosis
