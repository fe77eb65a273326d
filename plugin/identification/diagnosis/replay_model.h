#pragma once
// The replay of an experiment as a model for the diagnosis.

#include "plugin/identification/diagnosis/model/candidate_effects.h"
#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/recording/experiment/experiment.h"

#include <atomic>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::diagnosis {

/// Largest curvature change in the run with the largest displacement, with the stated parameters, 1/m.
double largestBend(const experiment::Experiment& experiment, const std::atomic<bool>* interrupt);

/// Readings of a simulated run; not a number after the end of a simulation.
Response responseOf(const experiment::Experiment& experiment, std::size_t run, const replay::Simulated& simulated);

struct StartedLaw;

class ReplayModel final : public Model {
public:
    /// `experiment` must outlive the model. The constructor simulates one run; after an interruption the model is
    /// unusable.
    explicit ReplayModel(const experiment::Experiment& experiment, const std::vector<std::string>& without = {},
                         const std::atomic<bool>* interrupt = nullptr);

    [[nodiscard]] const std::vector<Scalar>& nominal() const override { return nominal_; }
    [[nodiscard]] const std::vector<CandidateEffect>& candidates() const override {
        return candidateEffects_.candidates;
    }
    [[nodiscard]] std::size_t replicateOf(std::size_t run) const override { return replicates_[run]; }
    [[nodiscard]] Response simulate(std::size_t run, const ParameterPoint& point, Fidelity fidelity,
                                    const std::atomic<bool>* interrupt) const override;
    [[nodiscard]] std::vector<BatchFactor> batch() const override { return batch_; }
    [[nodiscard]] ParameterPoint simulated(std::size_t run, const ParameterPoint& point) const override;
    void read(std::size_t run, const ParameterPoint& point, Response& response) const override;
    [[nodiscard]] std::vector<CandidateRun> candidateRuns() const override;
    [[nodiscard]] CandidateRunResponse simulateCandidateRun(std::size_t index, const ParameterPoint& point,
                                                            const std::atomic<bool>* interrupt) const override;
    [[nodiscard]] std::string identity() const override;

    /// Lets a law of the user compete with the catalogue. Empty, or why it cannot.
    [[nodiscard]] std::string add(const StartedLaw& law);
    /// Lets effects act in all simulations, with these values.
    void fix(std::vector<effects::Setting> effects) { fixed_ = std::move(effects); }
    /// The parameters of a point, or an error text. Learned laws of the reading have none.
    [[nodiscard]] std::string parametersAt(const ParameterPoint& point, replay::Parameters& parameters) const;
    /// Why the parameters of a point do not give its readings; empty: they do.
    [[nodiscard]] std::string withoutParameters(const ParameterPoint& point) const;

private:
    void addReading(const Term& term, std::size_t run, const std::vector<double>& time, Response& response) const;
    [[nodiscard]] std::string setNominal(replay::Parameters& parameters, std::size_t index, double value) const;

    const experiment::Experiment& experiment_;
    std::vector<Scalar> nominal_;
    std::vector<effects::Setting> fixed_;
    std::vector<BatchFactor> batch_;
    double largestBend_ = 0.0; ///< 1/m
    CandidateEffects candidateEffects_;
    std::vector<std::size_t> replicates_;  ///< see replicateOf()
    double travel_ = 1.0, duration_ = 1.0; ///< m, s, scales of learned readings
};

} // namespace supercircle::diagnosis
