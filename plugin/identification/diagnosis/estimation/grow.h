#pragma once
// Fits of runs that keep their own time. A wrong frequency turns a long free swing against the recorded one, and the
// misfit has a minimum at every whole turn; over the first swing it has one. So a fit begins with the first eighth of
// every run and goes on with twice as much from where that ended.
//
// Source: H. U. Voss, J. Timmer, J. Kurths, "Nonlinear dynamical system identification from uncertain and indirect
// measurements", Int. J. Bifurcation Chaos 14 (2004) 1905, sec. 4 (initial value approach and its minima).

#include "plugin/identification/diagnosis/fit.h"

namespace supercircle::diagnosis {

/// Where a fit of all rows should start; `start` itself where nothing is free or it cannot be simulated.
Point grown(Evaluator& evaluator, const Misfit& misfit, const Point& start, const FitSettings& settings);

} // namespace supercircle::diagnosis
