#include "plugin/identification/diagnosis/next.h"
#include "plugin/pages/diagnosis/diagnose_page.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

using Json = nlohmann::ordered_json;
using diagnosis::Diagnosis;
using diagnosis::FoundEffect;
using diagnosis::Window;

Json finite(double v) {
    return std::isfinite(v) ? Json(v) : Json(nullptr);
}

Json windowsOf(const diagnosis::Localisation& l) {
    static constexpr const char* kKinds[] = {"shift", "energy", "effect"}; // of diagnosis::Seen
    Json all = Json::array();
    for (const Window& w : l.significant)
        all.push_back({{"run", w.run},
                       {"t_start_s", w.timeFrom},
                       {"t_end_s", w.timeTo},
                       {"displacement_from_mm", 1e3 * w.displacementFrom},
                       {"displacement_to_mm", 1e3 * w.displacementTo},
                       {"phase", w.phase},
                       {"channel", w.channel},
                       {"z", w.z},
                       {"p_value", w.p},
                       {"arc_fraction", w.ofMarker() ? Json(w.arcFraction) : Json(nullptr)},
                       {"kind", kKinds[static_cast<std::size_t>(w.by)]}});
    return all;
}

/// Of an effect that may act to either side, else null.
Json sizesOf(const diagnosis::Interval& ci) {
    if (!ci.eitherSide)
        return nullptr;
    return {finite(ci.least), finite(std::max(std::abs(ci.low), std::abs(ci.high)))};
}

Json parametersOf(const std::vector<diagnosis::FittedParameter>& all) {
    Json out = Json::object();
    for (const diagnosis::FittedParameter& p : all)
        out[p.name] = {{"value", finite(p.value)},
                       {"unit", p.unit},
                       {"ci90", {finite(p.ci90.low), finite(p.ci90.high)}},
                       {"either_side", p.ci90.eitherSide},
                       {"size_ci90", sizesOf(p.ci90)},
                       {"shown_only_by", p.only.empty() ? Json(nullptr) : Json(p.only)}};
    return out;
}

Json effectOf(const FoundEffect& e, const std::string& unit) {
    return {{"label", e.label},
            {"probability", e.probability},
            {"group", e.group},
            {"together_with", e.with},
            {"pressed_beyond_plausible", e.pressed},
            {"slot", e.slot},
            {"law", e.form.empty() ? e.law : e.form + ": " + e.law},
            {"parameters", parametersOf(e.parameters)},
            {"products", parametersOf(e.products)},
            {"heldout_gain", e.gain},
            {"heldout_gain_error", e.gainError},
            {"training_rmse" + unit, e.trainingRmse},
            {"heldout_rmse" + unit, e.heldOutRmse},
            {"misfit_per_row", e.misfitPerRow}};
}

Json screenOf(const Diagnosis& d) {
    Json all = Json::array();
    for (const diagnosis::SeenEffect& s : d.seen)
        all.push_back({{"label", s.label},
                       {"explains", s.gain},
                       {"absorbed_share", s.absorbed},
                       {"visible_in_relevant_sizes", finite(s.visible)},
                       {"probability_unseen", s.unseen}});
    return all;
}

Json learnedOf(const Diagnosis& d) {
    Json all = Json::array();
    for (const diagnosis::LearnedLaw& l : d.learned)
        all.push_back({{"label", l.label},
                       {"slot", l.slot},
                       {"law", l.law},
                       {"words", l.words},
                       {"probability", l.probability},
                       {"heldout_gain", l.gain},
                       {"heldout_gain_error", l.gainError},
                       {"heldout_rmse_N", l.heldOutRmse},
                       {"of", l.of},
                       {"of_unit", l.ofUnit},
                       {"over", l.over},
                       {"over_unit", l.overUnit},
                       {"at", l.at},
                       {"value", l.value},
                       {"std", l.deviation},
                       {"visited", l.visited}});
    return all;
}

Json effectWindowsOf(const Diagnosis& d) {
    Json all = Json::array();
    for (const diagnosis::RunCurves& run : d.runs)
        for (const diagnosis::Stretch& s : run.shows)
            all.push_back({{"run", run.name}, {"t_start_s", s.from}, {"t_end_s", s.to}});
    return all;
}

Json nextOf(const diagnosis::NextExperiment& next) {
    Json runs = Json::array();
    for (const diagnosis::FurtherRun& r : next.runs)
        runs.push_back({{"what", r.design.what},
                        {"repeats", r.repeats},
                        {"drive", {{"time_s", r.design.time}, {"displacement_m", r.design.displacement}}},
                        {"specimen_turned", r.design.turned},
                        {"new_markers_arc_fraction", r.design.markers},
                        {"markers_sampling_Hz", r.design.markerRate},
                        {"sampling_Hz", r.design.rate}});
    return {{"what", diagnosis::listed(next.runs)}, {"separates", next.separates}, {"tells_side", next.side},
            {"expected_power", next.power},         {"settles", next.settles},     {"runs", runs}};
}

} // namespace

std::string diagnosisJson(const Diagnosis& d) {
    const std::string unit = "_" + d.unit;
    Json effects = Json::array();
    for (const FoundEffect& e : d.effects)
        effects.push_back(effectOf(e, unit));
    Json nominal = Json::object();
    for (const diagnosis::NominalResult& n : d.nominal)
        nominal[n.name] = {{"stated", n.stated},
                           {"uncertainty", n.uncertainty},
                           {"fitted", n.fitted},
                           {"tension", n.tension},
                           {"unit", n.unit}};
    const auto errors = [&](double training, double heldOut) {
        return Json{{"training_rmse" + unit, finite(training)}, {"heldout_rmse" + unit, finite(heldOut)}};
    };
    Json next = nullptr;
    if (d.next)
        next = nextOf(*d.next);
    const Json json = {
        {"verdict", d.verdict},
        {"statement", d.statement},
        {"noise",
         {{d.channel + "_std" + unit, d.noise.total()},
          {"correlation_time_s", d.noise.memory},
          {"source", d.noise.source},
          {"white_std" + unit, d.noise.white},
          {"correlated_std" + unit, d.noise.coloured},
          {"excess_kurtosis", d.noise.tails},
          {"marker_std_mm", 1e3 * d.noise.marker}}},
        {"mismatch", windowsOf(d.mismatch)},
        {"mismatch_p_value", d.mismatch.p},
        {"effects", effects},
        {"effect_windows", effectWindowsOf(d)},
        {"probability_nothing", d.nothing},
        {"probability_unseen", d.unseen()},
        {"probability_unknown", d.unknown},
        {"fit",
         {{"baseline", errors(d.baselineTraining, d.baselineHeldOut)},
          {"improved", errors(d.improvedTraining, d.improvedHeldOut)},
          {"noise_floor_rmse" + unit, d.noise.total()},
          {"improvement_ci90", {d.improvementCi.low, d.improvementCi.high}},
          {"baseline_misfit_per_row", finite(d.baselinePerRow)}}},
        {"nominal", nominal},
        {"homogeneity", {{"q", d.homogeneity.q}, {"degrees", d.homogeneity.degrees}, {"p_value", d.homogeneity.p}}},
        {"left_over", windowsOf(d.left)},
        {"learned_laws", learnedOf(d)},
        {"screen", screenOf(d)},
        {"next_experiment", next},
        {"notes", d.notes},
        {"seed", d.seed},
        {"elapsed_s", d.elapsed},
        {"forward_runs", d.forwardRuns}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace supercircle::cli
