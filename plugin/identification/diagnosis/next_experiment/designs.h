#pragma once
// Runs of an experiment that were not made: variations of its first run.
//
// None is faster than what was recorded. A run up to ten times as fast would say much of what depends on speed, and was
// offered for long: at first started with a blow, then with ramps of three periods of the specimen, at last only where
// nothing else told enough and with simulations taken to be twelve times as wrong (half a per cent of the peak). All
// four that were asked for and made with the second simulator of docs/proof.md led to a wrong name. With the true
// numbers the last one was met to 1.02 of its noise but for some 60 ms at the touch, the ramped turn and the release
// (off by up to 8 of 1.1 mN), and these were enough. What happens there at speeds that nobody has recorded, no recorded
// run can vouch for; how a law depends on speed a slower run tells, too.

#include "plugin/identification/diagnosis/model/model.h"
#include "plugin/recording/experiment/experiment.h"

#include <vector>

namespace supercircle::diagnosis {

std::vector<Design> designsFor(const experiment::Experiment& experiment);

/// The experiment with design `index` as its only run, without readings.
experiment::Experiment designed(const experiment::Experiment& experiment, std::size_t index);

} // namespace supercircle::diagnosis
