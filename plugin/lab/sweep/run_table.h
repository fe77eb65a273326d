#pragma once
// The runs of a sweep as tables.

#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/result_store.h"
#include "plugin/lab/sweep/run_record.h"
#include "plugin/recording/table/recording.h"
#include "supercircle/support/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::sweep {

struct Row {
    std::size_t set = 0;
    std::int64_t seed = 0;
    std::string status, message;
    std::vector<std::optional<record::Value>> cells; ///< as RunTable::columns
    std::vector<record::Cycle> cycles;
    std::string host, build;
    double wall = 0.0, cpu = 0.0; ///< s
    /// Number in a column, NaN if there is none.
    [[nodiscard]] double number(std::size_t column) const;
};

/// All stored runs, ordered by (set, seed).
struct RunTable {
    std::vector<std::string> columns; ///< of the summary; they do not depend on the computer
    std::vector<Row> rows;
    /// Column by name; columns.size() if there is none.
    [[nodiscard]] std::size_t column(const std::string& name) const;
};

/// The runs of `sweep`'s sets in a store, of all seeds.
[[nodiscard]] Result<RunTable> collect(const SweepDefinition& sweep, ResultStore& store);

/// Force curves of the runs of one set, ordered by seed, at most `most` of them.
[[nodiscard]] Result<std::vector<RunRecord>> curvesOf(const SweepDefinition& sweep, std::size_t set, ResultStore& store,
                                                      std::size_t most);

/// One row a run: parameters, seed, status, summary. The bytes do not depend on interruptions of the sweep.
[[nodiscard]] std::string resultsCsv(const SweepDefinition& sweep, const RunTable& table);
/// One row a cycle; empty if the runs have none.
[[nodiscard]] std::string cyclesCsv(const SweepDefinition& sweep, const RunTable& table);
/// Time, computer and program of every run.
[[nodiscard]] std::string timingsCsv(const SweepDefinition& sweep, const RunTable& table);
/// Runs that failed or crashed, each with the command that repeats it alone; header only if there are none.
[[nodiscard]] std::string failedCsv(const SweepDefinition& sweep, const RunTable& table);
/// The command that repeats one run of the sweep alone.
[[nodiscard]] std::string commandOf(const SweepDefinition& sweep, std::size_t set, std::int64_t seed);

} // namespace supercircle::sweep
