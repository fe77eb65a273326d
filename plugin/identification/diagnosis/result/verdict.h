#pragma once
// The verdict and its sentences.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/model_weights.h"

namespace supercircle::diagnosis {

struct Evidence {
    double p = 1.0;                   ///< family-wise, of the largest statistic of the baseline
    double groupProbability = 0.0;    ///< probability of the first effect's confounded group
    double gain = 0.0, gainLow = 0.0; ///< of the first effect, and its lower bound (ModelWeights::gainLow)
    double adequate = 1.0;            ///< probability that nothing detectable is missing
    double outsideCatalogue = 0.0;
    double undetectable = 0.0; ///< fraction of relevant effects that are not detectable
    bool any = false;          ///< whether an effect was fitted
    bool searched = true;      ///< all effects were tried; false: the time limit ended the search
    bool forecastHolds = true; ///< of the shown hypothesis, in all free runs
    bool numbersOnly = false;  ///< the first hypothesis and all that cannot be told from it are stated numbers
    bool numbers = false;      ///< one of them is
};

/// Fraction of the effects with a noticeable signature at a relevant amplitude that these runs would not detect there;
/// 1 if there is none.
double undetectableShare(const std::vector<ScreenedEffect>& screening);

/// One of the five verdicts of diagnosis.json. No effect is identified where a stated number may be wrong instead.
std::string verdictOf(const Evidence& evidence);
/// Whether a wrong stated number explains the runs; the verdict on missing effects is "inconclusive" then.
bool isWrongNumber(Evidence evidence);

/// One or two plain sentences.
std::string statementOf(const Diagnosis& diagnosis, const Evidence& evidence);

/// Effects that no fit to these runs can distinguish. Without unloading, plasticity and nonlinear elasticity follow one
/// moment-curvature curve (flow and deformation theory agree under proportional loading: R. Hill, "The Mathematical
/// Theory of Plasticity" (1950), 2.7). The better fit only has the better curve.
bool structurallyIndistinguishable(const RecordedData& data, const std::string& a, const std::string& b);

} // namespace supercircle::diagnosis
