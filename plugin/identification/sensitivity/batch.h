#pragma once
// Many simulations at a time, in any order, with results in a fixed one (private to sensitivity/).

#include "plugin/identification/sensitivity/landmarks.h"
#include "plugin/identification/sensitivity/sensitivity.h"

#include <Eigen/Core>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace supercircle::sensitivity {

/// One simulation as numbers.
struct Observed {
    std::string failure;
    Eigen::VectorXd force;   ///< rows that were not reached are NaN
    Eigen::VectorXd markers; ///< x of marker 0 over time, then y, then marker 1, ...
    Landmarks landmarks;
};

struct Job {
    std::size_t run = 0;
    std::vector<double> values;
};

class Batch {
public:
    Batch(const Model& model, const experiment::Experiment& experiment, const Settings& settings);

    /// Simulates the model as it is; fills base and landmarks of every run.
    void runBases(Sensitivities& out);
    /// Simulates jobs; results in their order. `out` is charged with their cost.
    std::vector<Observed> run(const std::vector<Job>& jobs, Sensitivities& out);
    [[nodiscard]] bool stopped() const;
    /// Simulations that are expected in all, for the progress.
    void expect(std::size_t simulations) { expected_ = simulations; }

private:
    replay::Simulated simulate(const Job& job);
    void forEach(std::size_t count, const std::function<void(std::size_t)>& work);

    const Model& model_;
    const experiment::Experiment& experiment_;
    const Settings& settings_;
    const Sensitivities* bases_ = nullptr;
    std::size_t expected_ = 0, done_ = 0;
    std::mutex speaking_;
};

/// The numbers of a simulation whose shape is that of `like`; landmarks are not filled in.
Observed numbersOf(const replay::Simulated& simulated, const replay::Simulated& like);

} // namespace supercircle::sensitivity
