#pragma once
// Diagnosis of recordings with a model: noise, baseline fit, localisation, screening, selection, verdict, next
// experiment.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/result.h"

#include <functional>
#include <string>

namespace supercircle::diagnosis {

/// Parts of the method that can be switched off to measure what they contribute (decision 0093).
struct Ablation {
    bool whitening = false;       ///< noise is treated as white
    bool crossValidation = false; ///< hypotheses are ranked by the runs they were fitted to
    bool screening = false; ///< effects are screened by derivatives at zero amplitude instead of finite amplitudes
    bool openSet = false;   ///< the hypothesis "outside the catalogue" is left out
};

struct DiagnosisSettings {
    std::uint64_t seed = 1;
    int draws = 999;      ///< number of draws from the null distribution
    std::size_t fits = 6; ///< number of effects fitted with all parameters
    /// Whether to choose the next experiment where the question stays open. It takes a hundred simulations or more.
    bool nextExperiment = true;
    LikelihoodSettings likelihood;
    Ablation ablation;
    /// Fraction of the probe amplitudes at which effects are simulated (screen()).
    [[nodiscard]] double probeShare() const { return ablation.screening ? 1e-3 : 1.0; }
    std::function<void(double fraction, const std::string& stage)> progress;
};

/// @param data recordings of the runs that the model simulates
Diagnosis diagnose(const RecordedData& data, Evaluator& evaluator, const DiagnosisSettings& settings = {});

} // namespace supercircle::diagnosis
