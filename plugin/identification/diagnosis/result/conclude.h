#pragma once
// The verdict and its words.

#include "plugin/identification/diagnosis/result.h"
#include "plugin/identification/diagnosis/selection/weigh.h"

namespace supercircle::diagnosis {

struct Evidence {
    double p = 1.0;                   ///< of the largest window statistic of the nominal fit
    double bestGroup = 0.0;           ///< probability of the first effect's group
    double gain = 0.0, gainLow = 0.0; ///< of the first effect, and the low end of it (Weighed::gainLow)
    double nothing = 1.0;             ///< that nothing is missing which these runs could show
    double unknown = 0.0;
    double blind = 0.0; ///< share of the effects that matter in these runs but could not be seen
    bool any = false;   ///< whether an effect was fitted
};

/// One of the five verdicts of the contract.
std::string verdictOf(const Evidence& evidence);

/// One or two plain sentences.
std::string statementOf(const Diagnosis& diagnosis, const Evidence& evidence);

/// Effects that no fit to these runs can tell apart, however their laws are written: where nothing ever goes back, a
/// section that yields and one that is elastic and bends over follow one moment-curvature curve (flow and deformation
/// theory agree under proportional loading: R. Hill, "The Mathematical Theory of Plasticity" (1950), 2.7). The better
/// fit only says whose curve is written more aptly.
bool alikeByNature(const Data& data, const std::string& a, const std::string& b);

} // namespace supercircle::diagnosis
