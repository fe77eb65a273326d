#include "plugin/bench/bench_scaling.h"

#include <cmath>
#include <cstdio>

namespace supercircle::cli {

std::string number(const char* format, double value) {
    char text[48];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

namespace {

std::string line(const std::string& first, const std::vector<std::string>& cells) {
    std::string out = "| " + first + " |";
    for (const std::string& cell : cells)
        out += " " + cell + " |";
    return out + "\n";
}

std::string head(const std::string& first, const std::vector<std::string>& cells) {
    std::string out = line(first, cells) + "|---|";
    for (std::size_t i = 0; i < cells.size(); ++i)
        out += "---:|";
    return out + "\n";
}

std::string shellsOf(const ScalingRow& row) {
    return std::to_string(row.shells) + (row.complete ? "" : " (to " + row.reached + ")");
}

std::string costTable(const std::vector<ScalingRow>& rows) {
    std::string out =
        head("shells", {"contacts, most", "drop, CPU s", "cycle, CPU s", "steps", "solves", "ms a step", "memory, MB"});
    for (const ScalingRow& row : rows) {
        const bool cycle = row.cycleCpu > 0.0;
        const double cpu = cycle ? row.cycleCpu : row.dropCpu;
        out += line(shellsOf(row),
                    {number("%.0f", row.contacts), number("%.3g", row.dropCpu),
                     cycle ? number("%.3g", row.cycleCpu) : "-", number("%.0f", row.steps), number("%.0f", row.solves),
                     number("%.3g", 1e3 * cpu / std::max(1.0, row.steps)), number("%.0f", row.memory)});
    }
    return out;
}

std::string fullLoadTable(const std::vector<ScalingRow>& rows) {
    std::string out = head("shells", {"solves", "contacts", "active", "ms a solve", "of that the solver",
                                      "us an active contact", "pivots", "most", "pivots an active contact",
                                      "factorisations", "no Gauss-Seidel, %", "unsolved"});
    for (const ScalingRow& row : rows) {
        const FullLoad& f = row.full;
        const double active = std::max(1.0, f.activeContacts);
        out +=
            line(shellsOf(row), {number("%.0f", f.solves), number("%.0f", f.contacts), number("%.0f", f.activeContacts),
                                 number("%.3g", f.ms), number("%.3g", f.solverMs), number("%.3g", 1e3 * f.ms / active),
                                 number("%.3g", f.pivots), number("%.0f", f.mostPivots),
                                 number("%.2g", f.pivots / active), number("%.2g", f.factorisations),
                                 number("%.1f", 100.0 * f.pathOnly), number("%.0f", f.unsolved * f.solves)});
    }
    for (std::size_t k = 1; k < rows.size(); ++k) {
        const FullLoad &a = rows[k - 1].full, &b = rows[k].full;
        if (a.activeContacts > 0.0 && b.activeContacts > a.activeContacts)
            out += "\n" + std::to_string(rows[k - 1].shells) + " to " + std::to_string(rows[k].shells) +
                   " shells: ms a solve grows with the active contacts to the power " +
                   number("%.2f", std::log(b.ms / a.ms) / std::log(b.activeContacts / a.activeContacts)) + "\n";
    }
    return out;
}

std::string stageTable(const ScalingRow& row) {
    std::vector<std::string> titles{"CPU s", "share, %", "in loops, %"};
    for (const int threads : VirtualThreads::kThreads)
        if (threads > 1)
            titles.push_back("x" + std::to_string(threads));
    std::string out = head(shellsOf(row) + " shells", titles);
    VirtualThreads::Cost all;
    for (const VirtualThreads::Cost& cost : row.costs)
        all += cost;
    const auto put = [&](const std::string& name, const VirtualThreads::Cost& cost) {
        if (cost.total < 2e-3 * all.total)
            return;
        std::vector<std::string> cells{number("%.3g", cost.total), number("%.1f", 100.0 * cost.total / all.total),
                                       number("%.0f", 100.0 * cost.inside / cost.total)};
        for (std::size_t i = 1; i < VirtualThreads::kThreads.size(); ++i)
            cells.push_back(number("%.2f", cost.total / cost.time(i)));
        out += line(name, cells);
    };
    for (std::size_t i = 0; i < row.costs.size(); ++i) {
        const auto stage = static_cast<step::Stage>(i);
        put(stage == step::Stage::Count ? "between stages" : step::name(stage), row.costs[i]);
    }
    put("all", all);
    return out;
}

} // namespace

std::string scalingTables(const std::vector<ScalingRow>& rows) {
    std::string out = costTable(rows) + "\nUnder full load:\n\n" + fullLoadTable(rows) + "\n";
    for (const ScalingRow& row : rows)
        out += stageTable(row) + "\n";
    return out;
}

} // namespace supercircle::cli
