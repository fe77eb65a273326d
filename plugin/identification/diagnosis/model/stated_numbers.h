#pragma once
// Stated numbers that may be wrong, as hypotheses beside the effects of the catalogue.
//
// A fit keeps every stated number inside its interval. An effect would then have to explain what a wrong number does: a
// spring that is 10 % stiffer than stated would become a hardening one. Each number is a hypothesis of its own, with
// all others inside their intervals (decision 0231).

#include "plugin/identification/diagnosis/model/candidate_effects.h"

namespace supercircle::diagnosis {

/// Farthest from the stated value, in half-widths of its interval (Scalar::step). Half of it misses a factor of two of
/// a number known to 5 %; with twice as much no difference was seen.
constexpr double kFarthestNumber = 20.0;

/// Adds a candidate "stated_<name>" for each number that may be wrong (Scalar::doubtful).
/// @param nominal all numbers that a fit may change: CandidateEffect::number is an index into it
void addStatedNumbers(const std::vector<Scalar>& nominal, CandidateEffects& candidates);

} // namespace supercircle::diagnosis
