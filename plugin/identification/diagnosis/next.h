#pragma once
// Which further run would tell the leading rivals apart.
//
// Predictions of a run lie some way apart, but the run will be fitted again: what the recorded runs leave open in the
// numbers of a rival that is not true may take the difference up. So the distance is measured in the covariance
// 1 + J C J', with C the posterior of that one's fit and J the derivatives of the new run (noise units; force and
// markers), and in that of what every run has of its own and every simulation is off by: zero, clock, scale, contact
// places (sight.h: the run is compared as a recording of it would be). A sensor that is 6 ms late was to be told from
// nothing in a hold of 100 s, read 19 times a second, with a power of 1; a clock is known to a tenth of a row. Without
// all that, of seven runs that were proposed and made with the second simulator three settled the case: a wrong gain
// and a softening that is over in a quarter of a second differ by much in a slow run, until the modulus is fitted
// again.
//
// Where derivatives lead a refit is simulated, a few steps along them: derivatives of numbers that are open by much
// say that what is a radian late on a circle cannot be reached. The distance is the smaller of the two.
//
// What is open in the one that *is* true makes the distance uncertain instead: the power is its mean over that
// (assurance: A. O'Hagan, J. W. Stevens, M. J. Campbell, Pharm. Stat. 4 (2005) 187), and enough is what is enough with
// a probability of .9. Counted as something that takes the difference up, an effect of two deviations was never to be
// told from nothing by more than two, whatever run was made.
//
// Near the limit of detection nobody knows which effect it is: of a late sensor of eight deviations the screen made
// friction that depends on speed, and the run that tells this from nothing, a slow one, shows no late sensor. So every
// suspect is asked what a run would show if it were the one, weighed by how probable it is, and the
// rival counts that is hardest to refute. (An effect beside others cannot be refuted where these act alone.)
//
// What is weak beside the noise is told by no single run, but by several: n repeats lie sqrt(n) times as far apart as
// one, except for what a simulation is off by, which is the same in all of them (MisfitSettings::inEachOf()), and for
// what the recorded runs leave open, which the new ones come to know.
//
// Nor is what two suspects have in common in one run told by its repeats; a run of another kind may tell it. So where
// one run does not settle the matter, or takes four repeats and more, any two are looked at, up to eight runs in all.
// Without this, in eight of fourteen cases near the limit the diagnosis said itself that what it asked for might not
// settle them, and it did in three.

#include "plugin/identification/diagnosis/evaluator.h"
#include "plugin/identification/diagnosis/next_experiment/foretold.h"
#include "plugin/identification/diagnosis/noise.h"
#include "plugin/identification/diagnosis/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::diagnosis {

/// Simulates the designs with all rivals and takes the one that refutes whatever is not true by five units, with a
/// probability of .9, in the fewest repeats (of several the first), or two of them where that saves two runs at least;
/// else, with up to eight runs in all, the one or two that do best, which may not settle it. Their power is that of
/// one-sided tests at 5 %, the mean over what may be true. Empty if there are no two rivals, if no designs that can be
/// simulated tell a quarter of what is enough, or if the evaluator was stopped.
/// @param zeroWindow as Data::zeroWindow, s; 0: nobody tares the load cell
std::optional<NextExperiment> nextExperiment(Evaluator& evaluator, const std::vector<Rival>& rivals, const Noise& noise,
                                             double zeroWindow);

/// Where none was found: how many were tried, and what else there is to do.
std::string noneTells(const Diagnosis& d);

/// "a run ten times slower, at 0.2 mm/s, made 3 times, and two cycles".
std::string listed(const std::vector<FurtherRun>& runs);

/// The same of what is asked for, and that it may not settle the matter, if so.
std::string inWords(const NextExperiment& next);

} // namespace supercircle::diagnosis
