#pragma once
// Range of validity of the simulation without an effect: how far from its beginning each driven run is explained inside
// the stated intervals, and where it begins to depart.
//
// The longest beginning is found by bisection: a beginning is explained where its fit, linear in the parameters about
// the last one, leaves no misfit of family-wise p <= 0.05 (localise.h). The place of departure is the change point of
// the residual: an offset, a ramp or a parabola that begins there, whichever explains most (D. V. Hinkley, Biometrika
// 57, 1 (1970)). It is sought in a beginning long enough to show the departure with ten sigma. Its 90 % interval holds
// all places whose gain in chi-squared is within 2.71 of the largest.

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/likelihood.h"
#include "plugin/identification/diagnosis/result.h"

#include <cstdint>
#include <vector>

namespace supercircle::diagnosis {

/// One for each run. Throws Stopped.
std::vector<ValidRange> rangesOfValidity(Evaluator& evaluator, const Likelihood& likelihood, std::uint64_t seed);

} // namespace supercircle::diagnosis
