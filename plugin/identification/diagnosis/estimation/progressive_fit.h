#pragma once
// Progressive fit of free oscillations. The objective has a local minimum at every whole turn of phase error; over the
// first oscillation it has one. The fit therefore starts with the first eighth of every run and doubles the interval
// each time (decision 0094).
//
// Source: H. U. Voss, J. Timmer, J. Kurths, "Nonlinear dynamical system identification from uncertain and indirect
// measurements", Int. J. Bifurcation Chaos 14 (2004) 1905, sec. 4 (initial value approach and its minima).

#include "plugin/identification/diagnosis/fit.h"

namespace supercircle::diagnosis {

/// Start point for a fit of all rows. Returns `start` where nothing moves freely or the simulation fails.
ParameterPoint progressiveStart(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start,
                                const FitSettings& settings);

} // namespace supercircle::diagnosis
