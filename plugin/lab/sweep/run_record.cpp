#include "plugin/lab/sweep/run_record.h"

#include "plugin/recording/table/json_text.h"
#include "plugin/recording/table/text.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace supercircle::sweep {

namespace {

using Json = nlohmann::ordered_json;

/// Parts of a branch; each leaves at most three points (first, lowest, highest).
constexpr std::size_t kParts = 150;

/// Stored outside the record already.
bool storedElsewhere(const std::string& key) {
    return key == "scene" || key == "seed" || key == "status" || key == "message" || key == "threads";
}

/// Rows first to last (exclusive), thinned; extremes are kept.
CurveBranch thinned(const std::vector<double>& d, const std::vector<double>& f, std::size_t first, std::size_t last) {
    CurveBranch branch;
    const auto keep = [&](std::size_t row) {
        branch.displacement.push_back(static_cast<double>(static_cast<float>(d[row])));
        branch.force.push_back(static_cast<double>(static_cast<float>(f[row])));
    };
    const std::size_t rows = last - first;
    const std::size_t parts = std::min(kParts, rows);
    for (std::size_t p = 0; p < parts; ++p) {
        const std::size_t from = first + p * rows / parts, to = first + (p + 1) * rows / parts;
        const auto begin = f.begin() + static_cast<std::ptrdiff_t>(from),
                   end = f.begin() + static_cast<std::ptrdiff_t>(to);
        std::vector<std::size_t> chosen = {from, static_cast<std::size_t>(std::min_element(begin, end) - f.begin()),
                                           static_cast<std::size_t>(std::max_element(begin, end) - f.begin())};
        std::sort(chosen.begin(), chosen.end());
        chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
        for (const std::size_t row : chosen)
            keep(row);
    }
    if (rows > parts)
        keep(last - 1);
    return branch;
}

/// Split where the crosshead turns.
std::vector<CurveBranch> branchesOf(const record::Series& series) {
    const auto* d = series.find("displacement_m");
    const auto* f = series.find("force_N");
    std::vector<CurveBranch> branches;
    if (d == nullptr || f == nullptr || d->size() < 2)
        return branches;
    std::size_t first = 0;
    double direction = 0.0;
    for (std::size_t i = 1; i < d->size(); ++i) {
        const double step = (*d)[i] - (*d)[i - 1];
        if (step * direction < 0.0) {
            branches.push_back(thinned(*d, *f, first, i));
            first = i - 1; // the turning point belongs to both
        }
        if (step != 0.0)
            direction = step;
    }
    branches.push_back(thinned(*d, *f, first, d->size()));
    return branches;
}

Json toJson(const record::Value& value) {
    return std::visit([](const auto& v) { return Json(v); }, value);
}

record::Value fromJson(const Json& json) {
    if (json.is_boolean())
        return json.get<bool>();
    if (json.is_number_integer())
        return json.get<std::int64_t>();
    if (json.is_string())
        return json.get<std::string>();
    return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

void appendList(std::string& out, const std::vector<double>& values) {
    out += '[';
    for (std::size_t i = 0; i < values.size(); ++i) {
        out += i == 0 ? "" : ",";
        const auto small = static_cast<float>(values[i]);
        if (std::isfinite(small))
            record::appendNumber(out, small); // seven digits are enough for a picture
        else
            out += "null";
    }
    out += ']';
}

std::string branchesText(const std::vector<CurveBranch>& branches) {
    std::string out = "[";
    for (std::size_t i = 0; i < branches.size(); ++i) {
        out += i == 0 ? "[" : ",[";
        appendList(out, branches[i].displacement);
        out += ',';
        appendList(out, branches[i].force);
        out += ']';
    }
    return out + "]";
}

std::vector<double> numbers(const Json& list) {
    std::vector<double> values;
    for (const Json& v : list)
        values.push_back(v.is_number() ? v.get<double>() : std::numeric_limits<double>::quiet_NaN());
    return values;
}

} // namespace

RunRecord recordOf(const record::Recording& recording, const std::string& status, const std::string& message) {
    RunRecord result;
    result.status = status;
    result.message = message;
    for (const auto& [key, value] : recording.summary) {
        if (!storedElsewhere(key))
            result.summary.emplace_back(key, value);
    }
    result.timing = recording.timing;
    for (const auto& [key, value] : recording.energy)
        result.summary.emplace_back("energy_" + key, value);
    result.cycles = recording.cycles;
    result.branches = branchesOf(recording.series);
    return result;
}

std::string serialise(const RunRecord& result) {
    Json json = {{"status", result.status}, {"message", result.message}};
    json["summary"] = Json::object();
    for (const auto& [key, value] : result.summary)
        json["summary"][key] = toJson(value);
    json["timing"] = Json::object();
    for (const auto& [key, value] : result.timing)
        json["timing"][key] = value;
    json["cycles"] = Json::array();
    for (const record::Cycle& c : result.cycles)
        json["cycles"].push_back({c.delta_max_over_R, c.dissipation_ratio, c.snap_fits, c.dissipated_J});
    std::string text = record::jsonText(json, -1);
    text.back() = ','; // the curve is rounded to float, which the library's printer does not do
    return text + "\"branches\":" + branchesText(result.branches) + "}";
}

std::optional<RunRecord> deserialise(std::string_view text) {
    const Json json = record::tryParseJson(text);
    if (!json.is_object())
        return std::nullopt;
    try {
        RunRecord result;
        result.status = json.at("status").get<std::string>();
        result.message = json.at("message").get<std::string>();
        for (const auto& [key, value] : json.at("summary").items())
            result.summary.emplace_back(key, fromJson(value));
        for (const auto& [key, value] : json.at("timing").items())
            result.timing.emplace_back(key, value.is_number() ? value.get<double>() : 0.0);
        for (const Json& c : json.at("cycles"))
            result.cycles.push_back({numbers(c).at(0), numbers(c).at(1), c.at(2).get<int>(), numbers(c).at(3)});
        for (const Json& branch : json.at("branches"))
            result.branches.push_back({numbers(branch.at(0)), numbers(branch.at(1))});
        return result;
    } catch (const std::exception&) {
        return std::nullopt; // not a record of this version
    }
}

} // namespace supercircle::sweep
