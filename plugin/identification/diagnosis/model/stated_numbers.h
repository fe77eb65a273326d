#pragma once
// Stated numbers that may be wrong, as hypotheses beside the effects of the catalogue.
//
// A fit keeps every stated number inside its interval. What a number outside would explain is else called physics: a
// spring that is 10 % stiffer than stated becomes a hardening one. Each such number is a hypothesis of its own, with
// the fit of all others (decision 0231).

#include "plugin/identification/diagnosis/model/candidate_effects.h"

namespace supercircle::diagnosis {

/// Farthest from the stated value, in half-widths of its interval. Half of it misses a decimal lost from a number known
/// to 5 %; twice as much makes no difference to numbers that are farther off by a factor of two.
constexpr double kFarthestNumber = 20.0;

/// Adds a candidate for each doubtful number.
/// @param nominal the scalars that a fit may change
void addStatedNumbers(const std::vector<Scalar>& nominal, CandidateEffects& candidates);

} // namespace supercircle::diagnosis
