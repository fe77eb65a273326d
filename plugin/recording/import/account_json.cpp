// The report for programs.

#include "plugin/recording/import/template.h"
#include "plugin/recording/table/json_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace supercircle::importing {

namespace {

using Json = nlohmann::ordered_json;

const Json kNull = nullptr;

Json remarksJson(const std::vector<Remark>& remarks) {
    Json all = Json::array();
    for (const Remark& r : remarks)
        all.push_back({{"kind", word(r.kind)}, {"line", r.line > 0 ? Json(r.line) : kNull}, {"what", r.what}});
    return all;
}

Json sourceJson(const Source& s) {
    const Layout& l = s.table.layout;
    Json columns = Json::array(), metadata = Json::array();
    for (std::size_t c = 0; c < l.columns; ++c) {
        const Heading& h = s.table.headings[c];
        const bool used = s.table.channelOf[c] >= 0;
        columns.push_back({{"heading", h.text},
                           {"quantity", used ? Json(name(h.quantity)) : kNull},
                           {"unit", used ? Json(h.unit.name) : kNull},
                           {"unit_stated", used && h.unitStated},
                           {"factor_to_SI", used ? Json(h.unit.factor) : kNull}});
    }
    for (const HeaderEntry& m : l.metadata)
        metadata.push_back({{"line", m.line}, {"key", m.key}, {"value", m.value}});
    return {{"file", s.file},
            {"specimen", s.table.specimen.empty() ? kNull : Json(s.table.specimen)},
            {"rows_left_out", s.lost},
            {"encoding", s.text.encoding},
            {"line_ends", s.text.lineEnds},
            {"separator", separatorName(l.separator)},
            {"decimal_mark", std::string(1, l.numbers.decimal)},
            {"names_line", l.namesLine > 0 ? Json(l.namesLine) : kNull},
            {"units_line", l.unitsLine > 0 ? Json(l.unitsLine) : kNull},
            {"first_data_line", l.firstDataLine},
            {"rows", s.rows},
            {"columns", columns},
            {"header", metadata},
            {"remarks", remarksJson(s.table.remarks)}};
}

} // namespace

std::string accountJson(const Imported& all, const Description& description) {
    Json sources = Json::array(), runs = Json::array();
    for (const Source& s : all.sources)
        sources.push_back(sourceJson(s));
    for (const ImportedRun& run : all.runs)
        runs.push_back({{"file", run.file},
                        {"from", all.sources[run.source].file},
                        {"first_line", run.signals.line.front()},
                        {"last_line", run.signals.line.back()},
                        {"rows", run.signals.rows()},
                        {"sampling_hz", run.rate},
                        {"drive",
                         {{"tolerance_mm", 1e3 * run.drive.tolerance},
                          {"largest_deviation_mm", 1e3 * run.drive.largestDistance},
                          {"noise_mm", 1e3 * run.drive.noise},
                          {"segments", run.drive.time.empty() ? 0 : run.drive.time.size() - 1}}},
                        {"force_noise_N", run.forceNoise},
                        {"force_zero_subtracted_N", run.forceZero},
                        {"first_contact_mm", std::isfinite(run.firstContact) ? Json(1e3 * run.firstContact) : kNull},
                        {"remarks", remarksJson(run.remarks)}});
    const Json json = {{"sources", sources},
                       {"runs", runs},
                       {"derived", description.remarks},
                       {"assumed", description.assumed},
                       {"to_be_filled_in", description.todo}};
    return record::jsonText(json) + "\n";
}

} // namespace supercircle::importing
