// The results of one size as a file.

#include "plugin/bench/bench_scaling.h"

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/json_text.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace supercircle::cli {

namespace {

using json = nlohmann::ordered_json;

/// Calls visit(key, number) for every number of a row, for writing and reading.
template <class Row, class Visit>
void numbers(Row& row, Visit&& visit) {
    visit("contacts", row.contacts);
    visit("drop_cpu_s", row.dropCpu);
    visit("cycle_cpu_s", row.cycleCpu);
    visit("steps", row.steps);
    visit("solves", row.solves);
    visit("memory_MB", row.memory);
    visit("full_load_solves", row.full.solves);
    visit("full_load_contacts", row.full.contacts);
    visit("full_load_active_contacts", row.full.activeContacts);
    visit("full_load_pivots", row.full.pivots);
    visit("full_load_pivots_most", row.full.mostPivots);
    visit("full_load_factorisations", row.full.factorisations);
    visit("full_load_gauss_seidel_iterations", row.full.iterations);
    visit("full_load_ms", row.full.ms);
    visit("full_load_solver_ms", row.full.solverMs);
    visit("full_load_path_only", row.full.pathOnly);
    visit("full_load_unsolved", row.full.unsolved);
}

std::string stageName(std::size_t i) {
    const auto stage = static_cast<step::Stage>(i);
    return stage == step::Stage::Count ? "between" : step::name(stage);
}

} // namespace

std::string scalingFile(int shells) {
    return "out/scaling/" + std::to_string(shells) + ".json";
}

std::string saveScaling(const ScalingRow& row) {
    json out = {{"shells", row.shells}, {"complete", row.complete}, {"reached", row.reached}};
    numbers(row, [&](const char* key, double value) { out[key] = value; });
    out["threads"] = VirtualThreads::kThreads;
    for (std::size_t i = 0; i < row.costs.size(); ++i)
        out["stages"][stageName(i)] = {{"cpu_s", row.costs[i].total},
                                       {"in_loops_s", row.costs[i].inside},
                                       {"loops", row.costs[i].loops},
                                       {"span_s", row.costs[i].span}};
    const std::filesystem::path path(scalingFile(row.shells));
    std::error_code ignored;
    std::filesystem::create_directories(path.parent_path(), ignored);
    return record::writeAtomically(path.parent_path().string(),
                                   {{path.filename().string(), record::jsonText(out) + "\n"}})
        .error();
}

bool loadScaling(int shells, ScalingRow& row) {
    std::ifstream file(scalingFile(shells));
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    const json in = record::tryParseJson(text);
    if (!in.is_object())
        return false;
    try {
        if (in.at("threads").get<std::vector<int>>() !=
            std::vector<int>(VirtualThreads::kThreads.begin(), VirtualThreads::kThreads.end()))
            return false;
        row.shells = in.at("shells").get<int>();
        row.complete = in.at("complete").get<bool>();
        row.reached = in.at("reached").get<std::string>();
        numbers(row, [&](const char* key, double& value) { value = in.at(key).get<double>(); });
        for (std::size_t i = 0; i < row.costs.size(); ++i) {
            const json& stage = in.at("stages").at(stageName(i));
            VirtualThreads::Cost& cost = row.costs[i];
            cost.total = stage.at("cpu_s").get<double>();
            cost.inside = stage.at("in_loops_s").get<double>();
            cost.loops = stage.at("loops").get<double>();
            stage.at("span_s").get_to(cost.span);
        }
    } catch (const json::exception&) {
        return false; // written by another version: measured again
    }
    return row.shells == shells;
}

} // namespace supercircle::cli
