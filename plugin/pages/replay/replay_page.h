#pragma once
// The pictures and the page of the verb `replay`.

#include "plugin/identification/replay/compare.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/result.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// One run, recorded and simulated.
struct ReplayedRun {
    std::string name; ///< of its files, "run_1"
    replay::Simulated simulated;
    replay::Comparison comparison;
};

/// Everything a replay found out.
struct Replay {
    experiment::Experiment experiment;
    replay::Parameters parameters;
    replay::Resolution resolution;
    std::vector<ReplayedRun> runs; ///< as many of the experiment's as were simulated
};

/// NAME_replay.png per run and replay.html, by name and content.
record::Result<std::vector<record::NamedText>> replayPages(const Replay& replay);

} // namespace supercircle::cli
