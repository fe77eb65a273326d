#pragma once
// Readings while the head stands still: where noise is told from everything else, and where a reading that swings by
// itself shows (a pump, the mains, a building), which no specimen does.

#include "plugin/diagnosis/data.h"

#include <Eigen/Core>
#include <vector>

namespace supercircle::diagnosis {

/// A stretch of rest and what is taken out of it.
struct Rest {
    std::size_t run = 0;
    Eigen::VectorXd time, force; ///< s, N
    Eigen::MatrixXd trends;      ///< columns: mean and, behind a motion, slope and logarithm of time: it may relax
};

std::vector<Rest> restsOf(const Data& data);

/// Of white and first-order coloured noise (N, N, s), the trends' share integrated out.
double restrictedLogLikelihood(const Rest& rest, double white, double coloured, double memory);

/// A sine of one period in all runs, its amplitude and phase each run's own.
struct Swing {
    double period = 0.0;                    ///< s; 0: none
    std::vector<double> cosine, sine;       ///< of each run, N, over the run's own time
    double explained = 0.0;                 ///< of the rests\' squared deviations, noise units
    [[nodiscard]] double amplitude() const; ///< N, root mean square over the runs that rest
    [[nodiscard]] double at(std::size_t run, double time) const;
};

/// The sine that explains most of what rests show beyond such noise and beyond relaxations of 0.3, 1 and 3 s, which
/// come again in every cycle; a run must rest for two of its periods.
Swing largestSwing(const Data& data, const std::vector<Rest>& rests, double white, double coloured, double memory);

} // namespace supercircle::diagnosis
