#pragma once
// Whether numbers that could be read can be what they are said to be (private to experiment/).
//
// A recording is refused where a replay would mislead (a constant channel, another unit, times that run back, a motion
// that is not the commanded one) and repaired, with a note that says so, where nothing is lost by it: single missing
// samples, far more rows than any simulation resolves, a sampling rate that is stated wrongly.

#include "plugin/recording/experiment/experiment.h"
#include "plugin/scene/loader/problem.h"

#include <string>
#include <vector>

namespace supercircle::experiment {

/// Most rows a recording keeps; more are averaged in blocks.
inline constexpr std::size_t maxRows = 50000;

/// Judges and repairs the readings of a run. `path` is the file they come from.
void judgeReadings(const Experiment& experiment, Run& run, const std::string& path,
                   std::vector<scene::Problem>& problems);

/// The same for its markers.
void judgeTracks(const Experiment& experiment, Run& run, const std::string& path,
                 std::vector<scene::Problem>& problems);

/// A number in a message, to four digits.
std::string shown(double v);

/// A remark about the description, at a JSON pointer.
struct Remark {
    std::string pointer;
    std::string what;
    std::string expected;
    bool error = false;
};

/// Statements of the description that contradict each other.
std::vector<Remark> contradictions(const Experiment& experiment);

} // namespace supercircle::experiment
