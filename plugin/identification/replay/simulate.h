#pragma once
// Simulation of a recorded run: the same motion of the drive, sampled at the recorded times, with the same force zero.

#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/experiment/experiment.h"
#include "plugin/recording/experiment/natural_units.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace supercircle::replay {

/// Resolution of a simulation. Lengths and times are those of the reference specimen; they scale with the set-up.
struct Resolution {
    int elements = 21;               ///< arcs per specimen, at least (rod::elementsMeetingAt of the clamp)
    double positionTolerance = 4e-7; ///< m, local error of a position per step
    double travelMax = 2e-5;         ///< m, longest travel of the crosshead in one step
    double dtMax = 0.5;              ///< s, longest step
    double freeStep = 2e-3;          ///< s, step of a free scene

    /// The same for a set-up, in SI units.
    [[nodiscard]] Resolution in(const experiment::NaturalUnits& units) const;

    /// For residuals (cost and accuracy: simulate.cpp).
    static Resolution fine();
    /// For derivatives and searches.
    static Resolution coarse();
    /// The fine one with arcs (steps of a free scene) half as long, for the discretisation error.
    static Resolution finer();
};

/// Readings of the simulated sensors, at the recorded times, or at the sampling rate of a run without readings.
struct Simulated {
    std::string failure;                 ///< why the run is incomplete; then rows end early
    bool stopped = false;                ///< interrupted
    experiment::Readings readings;       ///< displacement as commanded
    experiment::MarkerTracks markers;    ///< at the recording's marker times
    experiment::Readings trace;          ///< readings at the steps of the simulation
    double forceZero = 0.0;              ///< N, subtracted from the force
    double largestCurvatureChange = 0.0; ///< 1/m, largest change of curvature from the natural one
    double cpuSeconds = 0.0;             ///< s, of the calling thread
    std::uint64_t steps = 0;             ///< accepted
    std::uint64_t rejected = 0;
    std::uint64_t unconverged = 0; ///< accepted with a contact residual above tolerance
};

struct Options {
    const std::atomic<bool>* interrupt = nullptr;  ///< becomes true: stop
    std::function<void(double fraction)> progress; ///< called after each step with the completed share of the drive
};

/// Whether runs are compared by the force of the machine.
bool comparesForce(const experiment::Experiment& experiment);

/// Simulates run `run` of the experiment. Deterministic; independent calls may run in parallel.
Simulated simulate(const experiment::Experiment& experiment, std::size_t run, const Parameters& parameters,
                   const Resolution& resolution, const Options& options = {});

} // namespace supercircle::replay
