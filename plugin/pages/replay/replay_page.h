#pragma once
// Figures and page of the subcommand `replay`.

#include "plugin/identification/replay/compare.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/recording/table/files.h"
#include "supercircle/support/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// One run, recorded and simulated.
struct ReplayedRun {
    std::string name; ///< of its files, such as "run_1"
    replay::Simulated simulated;
    replay::Comparison comparison;
};

/// The fit of a diagnosis that a replay takes.
struct TakenFit {
    std::string file, label;
    bool carried = false;                  ///< only its law, to this experiment
    std::vector<std::string> notes;        ///< of the law, in this section
    std::optional<replay::LawScore> score; ///< of a carried law
    std::string failure;                   ///< why there is no score; empty: there is
};

/// Result of a replay.
struct Replay {
    experiment::Experiment experiment;
    replay::Parameters parameters;
    replay::Resolution resolution;
    std::vector<ReplayedRun> runs; ///< the simulated runs of the experiment
    std::optional<TakenFit> taken; ///< its parameters and effects come from a diagnosis
};

/// replay.json.
std::string replayJson(const Replay& replay);

/// NAME_replay.png per run and replay.html, by name and content.
Result<std::vector<record::NamedText>> replayPages(const Replay& replay);

} // namespace supercircle::cli
