#pragma once
// Choice of the next experiment: which further run discriminates the competing hypotheses.
//
// The distance between two predictions is measured in the covariance 1 + J C J' of the new readings, because the new
// run will be fitted again. C is the posterior covariance of the hypothesis to be rejected, J its derivatives. Where
// derivatives lead, refits are simulated, and the smaller distance counts (decision 0086). Uncertainty of the true
// hypothesis makes the distance uncertain: the power is its mean (assurance: A. O'Hagan, J. W. Stevens, M. J. Campbell,
// Pharm. Stat. 4 (2005) 187).
//
// Every hypothesis is assumed true in turn, weighted by its probability; the alternative hardest to reject counts.
// Repeats and series of two kinds of runs are considered, up to eight runs (decision 0088).

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/next_experiment/predicted_run.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Simulates the candidate runs with all hypotheses. Chooses the one that rejects every false hypothesis by five sigma
/// with probability 0.9 in the fewest repeats, or two kinds of runs where that saves two runs. If none suffices,
/// chooses up to eight runs that discriminate most. Power is that of one-sided 5 % tests, averaged over the hypotheses.
/// Empty if there are fewer than two hypotheses, if no candidate run reaches a quarter of the required distance, or if
/// the evaluator was stopped.
/// @param zeroWindow as RecordedData::zeroWindow, s; 0: the load cell is not tared
[[nodiscard]] std::optional<NextExperiment> nextExperiment(Evaluator& evaluator,
                                                           const std::vector<CompetingHypothesis>& competing,
                                                           const Noise& noise, double zeroWindow);

/// Sentence for the case that no candidate run discriminates.
std::string noRunDiscriminates(const Diagnosis& d);

/// "a run ten times slower, at 0.2 mm/s, made 3 times, and two cycles".
std::string describeRuns(const std::vector<FurtherRun>& runs);

/// Description of the next experiment, with a remark if it may be inconclusive.
std::string describeNext(const NextExperiment& next);

} // namespace supercircle::diagnosis
