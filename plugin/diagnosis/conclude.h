#pragma once
// The verdict and its words.

#include "plugin/diagnosis/result.h"
#include "plugin/diagnosis/weigh.h"

namespace supercircle::diagnosis {

struct Evidence {
    double p = 1.0;                   ///< of the largest window statistic of the nominal fit
    double bestGroup = 0.0;           ///< probability of the first effect's group
    double gain = 0.0, gainLow = 0.0; ///< of the first effect, and the low end of it (Weighed::gainLow)
    double nothing = 1.0, unknown = 0.0;
    double blind = 0.0; ///< share of the effects that matter in these runs but could not be seen
    bool any = false;   ///< whether an effect was fitted
};

/// One of the five verdicts of the contract.
std::string verdictOf(const Evidence& evidence);

/// One or two plain sentences.
std::string statementOf(const Diagnosis& diagnosis, const Evidence& evidence);

} // namespace supercircle::diagnosis
