#pragma once
// From recordings and a model to a verdict: noise, nominal fit, where, what, how sure, and what to do next.

#include "plugin/identification/diagnosis/data.h"
#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/result.h"

#include <functional>
#include <string>

namespace supercircle::diagnosis {

/// Parts that can be taken out, to show what they are good for (docs/proof.md).
struct Ablation {
    bool whitening = false; ///< noise is taken as white
    bool heldOut = false;   ///< fits are ranked by the runs they were fitted to
    bool probes = false;    ///< effects are screened by their derivative where they are absent, not at finite sizes
    bool unknown = false;   ///< "none of these" is no hypothesis
};

struct Settings {
    std::uint64_t seed = 1;
    int draws = 999;      ///< of the null distribution
    std::size_t fits = 6; ///< effects that are fitted in full
    /// Choose the next run where the question stays open, which simulates a hundred and more that were not made.
    bool next = true;
    MisfitSettings misfit;
    Ablation ablation;
    /// Share of the probes' sizes at which effects are simulated (screen()).
    [[nodiscard]] double probeShare() const { return ablation.probes ? 1e-3 : 1.0; }
    std::function<void(double fraction, const std::string& stage)> progress;
};

/// @param data must fit the model's runs
Diagnosis diagnose(const Data& data, Evaluator& evaluator, const Settings& settings = {});

} // namespace supercircle::diagnosis
