#pragma once
// A recorded run simulated: the same machine motion, sampled at the recording's own times, force zero included.

#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/experiment.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace supercircle::replay {

/// How finely a run is computed.
struct Resolution {
    int elements = 31;               ///< arcs per specimen, at least (rod::elementsMeetingAt the clamp)
    double positionTolerance = 4e-7; ///< local error of a position per step, m
    double travelMax = 2e-5;         ///< longest way of the head in one step, m
    double dtMax = 0.5;              ///< longest step, s
    double freeStep = 2e-3;          ///< of a free scene, s

    /// For residuals (what it costs and how exact it is: simulate.cpp).
    static Resolution full();
    /// For derivatives and searches.
    static Resolution coarse();
    /// The full one with arcs (of a free scene steps) half as long: their difference is what arcs are to blame for.
    static Resolution finer();
};

/// What the sensors of the simulated machine read. Rows of readings as in the recording (the run's sampling times where
/// it has none).
struct Simulated {
    std::string failure;              ///< empty unless the run could not be finished; then rows end early
    bool stopped = false;             ///< interrupted
    experiment::Readings readings;    ///< displacement as commanded
    experiment::MarkerTracks markers; ///< at the recording's marker times
    experiment::Readings trace;       ///< the same between the samples: at the simulation's own steps
    double forceZero = 0.0;           ///< N, what was subtracted
    double bendMost = 0.0;            ///< largest change of curvature from the natural one, 1/m
    double cpuSeconds = 0.0;          ///< of the calling thread, s
    std::uint64_t steps = 0;          ///< accepted
    std::uint64_t rejected = 0;
    std::uint64_t unconverged = 0; ///< accepted with a contact residual above tolerance
};

struct Options {
    const std::atomic<bool>* interrupt = nullptr;  ///< becomes true: stop
    std::function<void(double fraction)> progress; ///< called after each step with the share of the drive done
};

/// Simulates run `run` of the experiment. Deterministic; independent calls may run in parallel.
Simulated simulate(const experiment::Experiment& experiment, std::size_t run, const Parameters& parameters,
                   const Resolution& resolution, const Options& options = {});

} // namespace supercircle::replay
