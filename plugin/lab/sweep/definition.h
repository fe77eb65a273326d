#pragma once
// A sweep as plain data: a scene, sets of parameter values, seeds (sweep.schema.json).

#include "plugin/scene/loader/problem.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supercircle::sweep {

/// Name and value of a scene's parameter, SI.
using ParameterValue = std::pair<std::string, double>;

struct SweepDefinition {
    std::string file; ///< as opened
    std::string name;
    std::string about;
    std::string scene;                     ///< path of the scene, as it can be opened from here
    std::vector<std::string> names;        ///< parameters that vary, in the order of the file
    std::vector<ParameterValue> fixed;     ///< parameters that have one value throughout
    std::vector<std::vector<double>> sets; ///< one value per name; the first name varies slowest
    std::vector<std::int64_t> seeds;       ///< each set is run once per seed
    std::string x;                         ///< parameter along the abscissa of pictures; empty: nothing varies
    std::string accuracy;                  ///< of all runs, as --accuracy names it; empty: as the scene says

    /// All parameters of a set: the fixed ones, then the varied ones.
    [[nodiscard]] std::vector<ParameterValue> parameterValues(std::size_t set) const;
};

/// One run of a sweep.
struct Task {
    std::size_t set = 0;
    std::int64_t seed = 0;
    friend bool operator==(const Task&, const Task&) = default;
};

/// Part `part` of `parts` (from 1) of a sweep's runs.
struct Shard {
    int part = 1, parts = 1;
};

/// The runs of a shard in the order of execution: seed by seed through all sets, so that all sets have equally many
/// runs whenever the sweep is stopped. The runs are dealt to the shards in turn.
[[nodiscard]] std::vector<Task> tasks(const SweepDefinition& sweep, const Shard& shard);

/// "name=value name=value", sorted by name, shortest digits: the name of a set in files.
[[nodiscard]] std::string keyOf(const std::vector<ParameterValue>& values);

/// Largest number of runs of one sweep.
inline constexpr std::size_t maxRuns = 10'000'000;

/// Seeds from "1:20", "7" or "1:5,8,10:12"; empty if it is none of these.
[[nodiscard]] std::vector<std::int64_t> parseSeeds(const std::string& text);
/// I/N, for example "1/4"; empty if it is none.
[[nodiscard]] std::optional<Shard> parseShard(const std::string& text);

/// Reads a sweep file. All problems are appended; the result is empty exactly if one of them is an error. The scene
/// itself is not opened.
[[nodiscard]] std::optional<SweepDefinition> load(const std::string& path, std::vector<scene::Problem>& problems);
/// The same from a text; `file` is what messages call it and what the scene's path is relative to.
[[nodiscard]] std::optional<SweepDefinition> loadText(const std::string& text, const std::string& file,
                                                      std::vector<scene::Problem>& problems);

} // namespace supercircle::sweep
