#pragma once
// The runs of a sweep as tables.

#include "plugin/lab/sweep/definition.h"
#include "plugin/lab/sweep/run_result.h"
#include "plugin/lab/sweep/store.h"
#include "plugin/recording/table/recording.h"
#include "plugin/recording/table/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::sweep {

struct Row {
    std::size_t set = 0;
    std::int64_t seed = 0;
    std::string status, message;
    std::vector<std::optional<record::Value>> cells; ///< as Table::columns
    std::vector<record::Cycle> cycles;
    std::string host, build;
    double wall = 0.0, cpu = 0.0; ///< s
    /// Number in a column, NaN if there is none.
    [[nodiscard]] double number(std::size_t column) const;
};

/// All runs that are done, ordered by (set, seed).
struct Table {
    std::vector<std::string> columns; ///< of the summary, the same for every machine and day
    std::vector<Row> rows;
    /// Column by name; columns.size() if there is none.
    [[nodiscard]] std::size_t column(const std::string& name) const;
};

/// The runs of `sweep`'s sets in a store, whatever their seeds.
[[nodiscard]] record::Result<Table> collect(const Definition& sweep, Store& store);

/// Force curves of the runs of one set, ordered by seed, at most `most` of them.
[[nodiscard]] record::Result<std::vector<RunResult>> curvesOf(const Definition& sweep, std::size_t set, Store& store,
                                                              std::size_t most);

/// One row a run: parameters, seed, status, summary. The same bytes whatever stopped the sweep in between.
[[nodiscard]] std::string resultsCsv(const Definition& sweep, const Table& table);
/// One row a cycle; empty if the runs have none.
[[nodiscard]] std::string cyclesCsv(const Definition& sweep, const Table& table);
/// What every run cost, on what machine, with what program.
[[nodiscard]] std::string timingsCsv(const Definition& sweep, const Table& table);
/// Runs that failed or died, each with the command that plays it alone; header only if there are none.
[[nodiscard]] std::string failedCsv(const Definition& sweep, const Table& table);
/// The command that plays one run of the sweep alone.
[[nodiscard]] std::string commandOf(const Definition& sweep, std::size_t set, std::int64_t seed);

/// A cell of a CSV file: quoted where it has to be.
[[nodiscard]] std::string cell(const std::string& text);

} // namespace supercircle::sweep
