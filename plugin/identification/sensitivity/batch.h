#pragma once
// Parallel simulations with results in a fixed order (private to sensitivity/).

#include "plugin/identification/sensitivity/landmarks.h"
#include "plugin/identification/sensitivity/sensitivity.h"

#include <Eigen/Core>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace supercircle::sensitivity {

/// Numbers of one simulation.
struct SimulatedValues {
    std::string failure;
    Eigen::VectorXd force;   ///< N; NaN after the end of the simulation
    Eigen::VectorXd markers; ///< m: x of marker 0 over time, then y, then marker 1, ...
    Landmarks landmarks;
};

struct SimulationJob {
    std::size_t run = 0;
    std::vector<double> values;
};

class Batch {
public:
    Batch(const Model& model, const experiment::Experiment& experiment, const SensitivitySettings& settings);

    /// Simulates all runs at the base values; sets base and landmarks of every run.
    void runBases(Sensitivities& out);
    /// Simulates jobs, with results in their order. Adds their cost to `out`.
    std::vector<SimulatedValues> run(const std::vector<SimulationJob>& jobs, Sensitivities& out);
    [[nodiscard]] bool stopped() const;
    /// Sets the expected number of simulations, for the progress.
    void expect(std::size_t simulations) { expected_ = simulations; }

private:
    replay::Simulated simulate(const SimulationJob& job);
    void forEach(std::size_t count, const std::function<void(std::size_t)>& work);

    const Model& model_;
    const experiment::Experiment& experiment_;
    const SensitivitySettings& settings_;
    const Sensitivities* bases_ = nullptr;
    std::size_t expected_ = 0, done_ = 0;
    std::mutex callbackMutex_;
};

/// Numbers of a simulation in the shape of `like`, without landmarks.
SimulatedValues numbersOf(const replay::Simulated& simulated, const replay::Simulated& like);

} // namespace supercircle::sensitivity
