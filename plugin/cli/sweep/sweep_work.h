#pragma once
// State shared by the engines of the subcommand `sweep`.

#include "plugin/cli/subcommands.h"
#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/result_store.h"

#include <string>

namespace supercircle::cli {

/// A sweep in progress.
struct SweepWork {
    sweep::SweepDefinition sweep;
    std::string sceneText;
    sweep::ResultStore store;
    sweep::Shard shard;
    std::size_t knownBefore = 0, crashed = 0, failed = 0;
    std::size_t missing = 0; ///< runs that are not in the store at the end
};

/// Runs what is missing as shards on a Slurm cluster, waits for them and merges them. Empty, or why not.
[[nodiscard]] std::string runOnCluster(const SweepArguments& arguments, SweepWork& work);

} // namespace supercircle::cli
