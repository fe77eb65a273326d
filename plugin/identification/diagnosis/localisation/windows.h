#pragma once
// Where a misfit is looked for: windows of readings, dyadic in time in each run and each stroke of its protocol (half
// overlapping), dyadic in displacement per phase over all runs (there unload against load too: a mean shift of opposite
// sign), whole runs, each coordinate of each marker over time, and the place of each jump.

#include "plugin/identification/diagnosis/misfit.h"

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// What says that something is there: a mean that is shifted, squares that are too large, or not the window itself but
/// the trace of an effect in all readings, which shows here.
enum class Seen : std::uint8_t { Shift, Energy, Trace };

struct Window {
    std::string run;                                     ///< name, or "all"
    std::string phase;                                   ///< loading, unloading, hold, all
    std::string axis;                                    ///< time, displacement, contrast (loading against unloading)
    std::string channel;                                 ///< Data::channel or the marker's name with _x, _y
    double timeFrom = 0.0, timeTo = 0.0;                 ///< s (over all runs: earliest and latest)
    double displacementFrom = 0.0, displacementTo = 0.0; ///< m
    double arcFraction = -1.0;                           ///< of a marker, -1: none
    double z = 0.0;                                      ///< standardised statistic
    Seen by = Seen::Shift;
    double p = 1.0; ///< family-wise
    [[nodiscard]] bool ofMarker() const { return arcFraction >= 0.0; }
};

/// A window and what of the stacked readings lies in it.
struct Spot {
    Window window;
    std::vector<Eigen::Index> rows; ///< of the stack, increasing
    Eigen::VectorXd sign;           ///< of each row, for opposite shifts; empty: all +1
};

/// All windows of a misfit; those with fewer than four rows that count are none, but for the jumps' own.
std::vector<Spot> windowsOf(const Misfit& misfit);

/// Times, displacements and phase of a window that is rows [from, to) of a run's force.
void setSpan(const RecordedRun& run, Eigen::Index from, Eigen::Index to, Window& window);

} // namespace supercircle::diagnosis
