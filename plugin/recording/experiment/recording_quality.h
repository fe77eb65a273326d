#pragma once
// Plausibility of recorded readings (private to experiment/). A recording is rejected where a replay would mislead: a
// constant channel, another unit, decreasing times, another motion than commanded. It is corrected with a note where
// nothing is lost: single missing samples, too many rows, a wrong sampling rate.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/scene/loader/problem.h"

#include <string>
#include <vector>

namespace supercircle::experiment {

/// Most rows a recording keeps; more are averaged in blocks.
inline constexpr std::size_t maxRows = 50000;

/// Checks and corrects the readings of a run. `path` is their file.
void checkReadings(const Experiment& experiment, Run& run, const std::string& path,
                   std::vector<scene::Problem>& problems);

/// The same for its markers.
void checkTracks(const Experiment& experiment, Run& run, const std::string& path,
                 std::vector<scene::Problem>& problems);

/// A number in a message, to four digits.
std::string shown(double v);

/// A remark about the description, at a JSON pointer.
struct Contradiction {
    std::string pointer;
    std::string what;
    std::string expected;
    bool error = false;
};

/// Contradictory statements of the description.
std::vector<Contradiction> contradictions(const Experiment& experiment);

} // namespace supercircle::experiment
