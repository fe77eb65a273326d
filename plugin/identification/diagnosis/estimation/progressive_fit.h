// Start of a fit of free oscillations. The objective of samples has a local minimum at every whole turn of phase error.
// Events, counted from the release, have none (event_fit.h). Runs with too few of them are fitted in growing pieces:
// the first eighth of every run, then twice as much each time (decision 0094).
//
// Source: H. U. Voss, J. Timmer, J. Kurths, "Nonlinear dynamical system identification from uncertain and indirect
// measurements", Int. J. Bifurcation Chaos 14 (2004) 1905, sec. 4 (initial value approach and its minima).

#include "plugin/identification/diagnosis/fit.h"

namespace supercircle::diagnosis {

/// The first `share` of the time of every run; later readings are missing.
RecordedData firstPart(const RecordedData& data, double share);

/// Start point for a fit of all rows. Returns `start` where nothing moves freely or the simulation fails.
ParameterPoint progressiveStart(Evaluator& evaluator, const Likelihood& likelihood, const ParameterPoint& start,
                                const FitSettings& settings);

} // namespace supercircle::diagnosis
