#pragma once
// What the engines of the verb `sweep` share.

#include "plugin/cli/verbs.h"
#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/store.h"

#include <string>

namespace supercircle::cli {

inline constexpr const char* kSweepFormat = "supercircle-sweep-store/1";
inline constexpr const char* kSweepStore = "results.sqlite"; ///< in the folder of a sweep or shard

/// A sweep at work.
struct SweepWork {
    sweep::Definition sweep;
    std::string sceneText;
    sweep::Store store;
    sweep::Shard shard;
    std::size_t playedBefore = 0, died = 0, failed = 0;
    std::size_t missing = 0; ///< runs that are not in the store at the end
};

/// Plays what is missing as shards on a Slurm cluster, waits for them and takes them over. Empty, or why not.
[[nodiscard]] std::string playOnCluster(const SweepArguments& arguments, SweepWork& work);

} // namespace supercircle::cli
