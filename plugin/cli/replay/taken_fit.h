#pragma once
// Fits of a diagnosis in a replay: --with and --carry.

#include "plugin/cli/subcommands.h"
#include "plugin/pages/replay/replay_page.h"

namespace supercircle::cli {

/// Sets parameters and effects by the named fit; false after a message.
[[nodiscard]] bool takeFit(const ReplayArguments& arguments, Replay& replay);

/// After the runs: scores the carried law. Nothing without --carry.
void scoreCarriedLaw(Replay& replay, bool quiet);

} // namespace supercircle::cli
