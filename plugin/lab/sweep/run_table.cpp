#include "plugin/lab/sweep/run_table.h"

#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace supercircle::sweep {

namespace {

std::string text(double value) {
    std::string out;
    record::appendNumber(out, value);
    return out;
}

std::string text(const record::Value& value) {
    if (const auto* d = std::get_if<double>(&value))
        return std::isfinite(*d) ? text(*d) : "";
    if (const auto* i = std::get_if<std::int64_t>(&value))
        return std::to_string(*i);
    if (const auto* b = std::get_if<bool>(&value))
        return *b ? "true" : "false";
    return record::csvCell(std::get<std::string>(value));
}

/// "phi_bar,mu,cycles,seed," and the like.
std::string headOf(const SweepDefinition& sweep) {
    std::string head;
    for (const ParameterValue& s : sweep.fixed)
        head += record::csvCell(s.first) + ",";
    for (const std::string& name : sweep.names)
        head += record::csvCell(name) + ",";
    return head + "seed";
}

std::string nameOf(const SweepDefinition& sweep, const Row& row) {
    std::string out;
    for (const ParameterValue& s : sweep.parameterValues(row.set))
        out += text(s.second) + ",";
    return out + std::to_string(row.seed);
}

std::map<std::string, std::size_t> keysOf(const SweepDefinition& sweep) {
    std::map<std::string, std::size_t> keys;
    for (std::size_t set = 0; set < sweep.sets.size(); ++set)
        keys.emplace(keyOf(sweep.parameterValues(set)), set);
    return keys;
}

void addCells(RunTable& table, Row& row, const RunRecord& result) {
    for (const auto& [key, value] : result.summary) {
        const std::size_t at = table.column(key);
        if (at == table.columns.size())
            table.columns.push_back(key);
        row.cells.resize(table.columns.size());
        row.cells[at] = value;
    }
}

} // namespace

double Row::number(std::size_t column) const {
    if (column >= cells.size() || !cells[column])
        return std::numeric_limits<double>::quiet_NaN();
    const record::Value& value = *cells[column];
    if (const auto* d = std::get_if<double>(&value))
        return *d;
    if (const auto* i = std::get_if<std::int64_t>(&value))
        return static_cast<double>(*i);
    return std::numeric_limits<double>::quiet_NaN();
}

std::size_t RunTable::column(const std::string& name) const {
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
}

Result<RunTable> collect(const SweepDefinition& sweep, ResultStore& store) {
    const auto keys = keysOf(sweep);
    std::vector<std::pair<Row, RunRecord>> found;
    const std::string error = store.forEach([&](const StoredRun& run) {
        const auto at = keys.find(run.parameters);
        if (at == keys.end())
            return;
        Row row;
        row.set = at->second;
        row.seed = run.seed;
        row.status = run.status;
        row.message = run.message;
        row.host = run.host;
        row.build = run.build;
        row.wall = run.wall;
        row.cpu = run.cpu;
        RunRecord result = deserialise(run.result).value_or(RunRecord{});
        row.cycles = result.cycles;
        result.branches.clear();
        found.emplace_back(std::move(row), std::move(result));
    });
    if (!error.empty())
        return Result<RunTable>::failure(error);
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return std::pair(a.first.set, a.first.seed) < std::pair(b.first.set, b.first.seed);
    });
    RunTable table;
    for (auto& [row, result] : found) {
        addCells(table, row, result);
        table.rows.push_back(std::move(row));
    }
    for (Row& row : table.rows)
        row.cells.resize(table.columns.size());
    return table;
}

Result<std::vector<RunRecord>> curvesOf(const SweepDefinition& sweep, std::size_t set, ResultStore& store,
                                        std::size_t most) {
    std::vector<RunRecord> all;
    const std::string key = keyOf(sweep.parameterValues(set));
    std::string error = store.forEach([&](const StoredRun& run) {
        if (run.parameters == key && run.status == "done" && all.size() < most)
            if (auto result = deserialise(run.result))
                all.push_back(std::move(*result));
    });
    return error.empty() ? Result<std::vector<RunRecord>>(std::move(all))
                         : Result<std::vector<RunRecord>>::failure(std::move(error));
}

std::string resultsCsv(const SweepDefinition& sweep, const RunTable& table) {
    std::string out = headOf(sweep) + ",status";
    for (const std::string& column : table.columns)
        out += "," + record::csvCell(column);
    out += '\n';
    for (const Row& row : table.rows) {
        out += nameOf(sweep, row) + "," + row.status;
        for (const auto& value : row.cells)
            out += "," + (value ? text(*value) : std::string());
        out += '\n';
    }
    return out;
}

std::string cyclesCsv(const SweepDefinition& sweep, const RunTable& table) {
    std::string out;
    for (const Row& row : table.rows)
        for (std::size_t i = 0; i < row.cycles.size(); ++i) {
            const record::Cycle& c = row.cycles[i];
            out += nameOf(sweep, row) + "," + row.status + "," + std::to_string(i + 1) + "," +
                   text(c.delta_max_over_R) + "," + text(c.dissipation_ratio) + "," + std::to_string(c.snap_fits) +
                   "," + text(c.dissipated_J) + "\n";
        }
    return out.empty()
               ? out
               : headOf(sweep) + ",status,cycle,delta_max_over_R,dissipation_ratio,snap_fits,dissipated_J\n" + out;
}

std::string timingsCsv(const SweepDefinition& sweep, const RunTable& table) {
    std::string out = headOf(sweep) + ",wall_s,cpu_s,host,build\n";
    for (const Row& row : table.rows)
        out += nameOf(sweep, row) + "," + text(row.wall) + "," + text(row.cpu) + "," + record::csvCell(row.host) + "," +
               record::csvCell(row.build) + "\n";
    return out;
}

std::string commandOf(const SweepDefinition& sweep, std::size_t set, std::int64_t seed) {
    std::string command = "supercircle run " + sweep.scene;
    for (const auto& [name, value] : sweep.parameterValues(set))
        command += " --param " + name + "=" + text(value);
    if (!sweep.accuracy.empty())
        command += " --accuracy " + sweep.accuracy;
    return command + " --seed " + std::to_string(seed);
}

std::string failedCsv(const SweepDefinition& sweep, const RunTable& table) {
    std::string out = headOf(sweep) + ",status,message,command\n";
    for (const Row& row : table.rows)
        if (row.status != "done")
            out += nameOf(sweep, row) + "," + row.status + "," + record::csvCell(row.message) + "," +
                   record::csvCell(commandOf(sweep, row.set, row.seed)) + "\n";
    return out;
}

} // namespace supercircle::sweep
