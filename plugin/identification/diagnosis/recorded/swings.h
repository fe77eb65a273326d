#pragma once
// A reading that swings by itself (a pump, the mains, a building), which no specimen does.
//
// It shows while the head rests, where a rest lasts for two of its periods. Where rests are shorter (.9 s, and a
// disturbance of 3 s: case 10 of seed 2038 in docs/proof.md) it counts as noise there, makes that three times as large,
// and what everybody sees in the misfit, a sine of five noise units, is "nothing missing". So it is looked for in what
// the nominal fit leaves of whole runs, too, where it must be told from physics that is missing. That is as if drawn
// from noise of a long memory: it bends with the drive, not with the clock, and runs of different speeds give it
// different periods.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/recorded/rests.h"

#include <cstddef>
#include <vector>

namespace supercircle::diagnosis {

/// White and first-order coloured noise.
struct Coloured {
    double white = 0.0, coloured = 0.0; ///< standard deviations, N
    double memory = 0.25;               ///< of the second, s
};

/// A sine of one period in all runs, its amplitude and phase each run's own.
struct Swing {
    double period = 0.0;                    ///< s; 0: none
    std::vector<double> cosine, sine;       ///< of each run, N, over the run's own time
    double explained = 0.0;                 ///< of the squared deviations, noise units
    [[nodiscard]] double amplitude() const; ///< N, root mean square over the runs that show one
    [[nodiscard]] double at(std::size_t run, double time) const;
    /// The recordings without it.
    [[nodiscard]] Data takenOut(const Data& data) const;
};

/// What it takes to state a sine, in the logarithm of a likelihood: size and phase in each run and one period among
/// some hundred.
double priceOfSwing(const Data& data);

/// The sine that explains most of what rests show beyond such noise and beyond relaxations of 0.3, 1 and 3 s, which
/// come again in every cycle.
/// @param periods that a run must rest for, at least
Swing largestSwing(const Data& data, const std::vector<Rest>& rests, const Coloured& noise, double periods);

/// The sine that is most of what a simulation leaves of the runs, if there is no doubt of one (period 0: none): the
/// longest run holds four periods, the runs that hold two of them swing alike within a factor of two, half of the
/// squares and more are the sine's, and beside it noise of any size and memory is more probable by priceOfSwing().
/// @param left per run, recorded minus simulated force, N; not finite where it says nothing
Swing swingOfMisfit(const Data& data, const std::vector<Eigen::VectorXd>& left);

} // namespace supercircle::diagnosis
