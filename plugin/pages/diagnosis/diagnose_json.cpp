#include "plugin/identification/diagnosis/next_experiment.h"
#include "plugin/pages/diagnosis/diagnose_page.h"
#include "plugin/pages/diagnosis/stored_fits_json.h"
#include "plugin/recording/table/json_text.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

using Json = nlohmann::ordered_json;
using diagnosis::Diagnosis;
using diagnosis::FittedEffect;
using diagnosis::ResidualWindow;

Json finite(double v) {
    return std::isfinite(v) ? Json(v) : Json(nullptr);
}

Json windowsOf(const diagnosis::Localisation& l, const Diagnosis& d) {
    static constexpr const char* kKinds[] = {"shift", "energy", "effect"}; // of diagnosis::StatisticKind
    Json all = Json::array();
    const bool load = d.drive && d.drive->isLoad;
    const double factor = d.drive ? d.drive->perUnit : 1e3;
    for (const ResidualWindow& w : l.significant)
        all.push_back({{"run", w.run},
                       {"t_start_s", d.table ? Json(nullptr) : Json(w.timeFrom)},
                       {"t_end_s", d.table ? Json(nullptr) : Json(w.timeTo)},
                       {load ? "load_from" : "displacement_from_mm", factor * w.displacementFrom},
                       {load ? "load_to" : "displacement_to_mm", factor * w.displacementTo},
                       {"phase", w.phase},
                       {"channel", w.channel},
                       {"z", w.z},
                       {"p_value", w.p},
                       {"arc_fraction", w.ofMarker() ? Json(w.arcFraction) : Json(nullptr)},
                       {"kind", kKinds[static_cast<std::size_t>(w.kind)]}});
    return all;
}

/// Interval of the magnitude where the sign is ambiguous, else null.
Json strengthOf(const diagnosis::Interval& ci) {
    if (!ci.signAmbiguous)
        return nullptr;
    return {finite(ci.smallestMagnitude), finite(std::max(std::abs(ci.low), std::abs(ci.high)))};
}

Json parametersOf(const std::vector<diagnosis::FittedParameter>& all, const std::vector<std::string>& atBound) {
    Json out = Json::object();
    for (const diagnosis::FittedParameter& p : all)
        out[p.name] = {{"value", finite(p.value)},
                       {"unit", p.unit},
                       {"ci90", {finite(p.ci90.low), finite(p.ci90.high)}},
                       {"resolves_sign", !p.ci90.signAmbiguous},
                       {"strength_ci90", strengthOf(p.ci90)},
                       {"at_prior_bound", std::find(atBound.begin(), atBound.end(), p.name) != atBound.end()},
                       {"identified_only_by", p.identifiedOnlyBy.empty() ? Json(nullptr) : Json(p.identifiedOnlyBy)}};
    return out;
}

/// Where the most probable effect is visible in the readings.
Json visibleIntervalsOf(const Diagnosis& d) {
    Json all = Json::array();
    for (const diagnosis::RunCurves& run : d.runs)
        for (const diagnosis::TimeInterval& s : run.visibleIntervals)
            all.push_back({{"run", run.name}, {"t_start_s", s.from}, {"t_end_s", s.to}});
    return all;
}

Json effectsOf(const Diagnosis& d) {
    const std::string unit = "_" + d.unit;
    Json all = Json::array();
    for (const FittedEffect& e : d.effects) {
        if (e.slot == diagnosis::kDescription)
            continue;
        all.push_back({{"label", e.label},
                       {"probability", e.probability},
                       {"confounded_with", e.confoundedWith},
                       {"joint_with", e.jointWith},
                       {"slot", e.slot},
                       {"law", e.variant.empty() ? e.law : e.variant + ": " + e.law},
                       {"parameters", parametersOf(e.parameters, e.atBound)},
                       {"derived", parametersOf(e.derived, e.atBound)},
                       {"delta_chi2", e.deltaChiSquared},
                       {"heldout_gain", e.gain},
                       {"heldout_gain_error", e.gainError},
                       {"training_rmse" + unit, e.trainingRmse},
                       {"heldout_rmse" + unit, e.heldOutRmse},
                       {"chi2_per_reading", e.chiSquaredPerReading},
                       {"visible_intervals", &e == &d.effects.front() ? visibleIntervalsOf(d) : Json::array()}});
        if (e.starts > 0) {
            all.back()["starts"] = e.starts;
            all.back()["starts_agreed"] = e.startsAgreed;
        }
    }
    return all;
}

/// Stated numbers as hypotheses beside the effects.
Json numbersOf(const Diagnosis& d) {
    Json all = Json::array();
    for (const FittedEffect& e : d.effects) {
        if (e.slot != diagnosis::kDescription || e.parameters.empty())
            continue;
        const diagnosis::FittedParameter& p = e.parameters.front();
        all.push_back({{"name", p.name},
                       {"unit", p.unit},
                       {"value", p.value},
                       {"ci90", {finite(p.ci90.low), finite(p.ci90.high)}},
                       {"probability", e.probability},
                       {"joint_with", e.jointWith},
                       {"confounded_with", e.confoundedWith},
                       {"heldout_gain", e.gain},
                       {"heldout_rmse_" + d.unit, e.heldOutRmse}});
    }
    return all;
}

Json screeningOf(const Diagnosis& d) {
    Json all = Json::array();
    for (const diagnosis::ScreenedEffect& s : d.screening)
        all.push_back({{"label", s.label},
                       {"delta_chi2", s.gain},
                       {"p_value", diagnosis::screeningP(s)},
                       {"absorbed_fraction", s.absorbedFraction},
                       {"detectable_at_relevant_size", finite(s.detectable)},
                       {"probability_undetectable", s.undetectable}});
    return all;
}

/// Smallest and largest state that the runs cover, or null.
Json stateRangeOf(const diagnosis::LearnedLaw& l) {
    Json range = nullptr;
    for (std::size_t i = 0; i < l.states.size(); ++i)
        if (l.inStateRange[i])
            range = {range.is_null() ? Json(l.states[i]) : range[0], l.states[i]};
    return range;
}

Json learnedOf(const Diagnosis& d) {
    Json all = Json::array();
    for (const diagnosis::LearnedLaw& l : d.learned)
        all.push_back({{"label", l.label},
                       {"slot", l.slot},
                       {"law", l.law},
                       {"description", l.description},
                       {"probability", l.probability},
                       {"heldout_gain", l.gain},
                       {"heldout_gain_error", l.gainError},
                       {"heldout_rmse_N", l.heldOutRmse},
                       {"response", l.response},
                       {"response_unit", l.responseUnit},
                       {"state", l.state},
                       {"state_unit", l.stateUnit},
                       {"state_range", stateRangeOf(l)},
                       {"state_values", l.states},
                       {"response_values", l.value},
                       {"response_std", l.sigma},
                       {"in_state_range", l.inStateRange}});
    return all;
}

Json furtherRunOf(const diagnosis::FurtherRun& r) {
    Json changed = Json::array();
    for (const diagnosis::ChangedParameter& c : r.candidateRun.changed)
        changed.push_back({{"name", c.name}, {"unit", c.unit}, {"from", c.from}, {"to", c.to}});
    return {{"description", r.candidateRun.description},
            {"repeats", r.repeats},
            {"changed", std::move(changed)},
            {"duration_s", r.candidateRun.time.empty() ? r.candidateRun.duration
                                                       : r.candidateRun.time.back() - r.candidateRun.time.front()},
            {"drive", {{"time_s", r.candidateRun.time}, {"displacement_m", r.candidateRun.displacement}}},
            {"specimen_rotation", r.candidateRun.specimenReversed},
            {"new_markers_arc_fraction", r.candidateRun.markers},
            {"markers_sampling_Hz", r.candidateRun.markerRate},
            {"sampling_Hz", r.candidateRun.rate}};
}

/// The keys of the first run stand at the top level too.
Json nextOf(const diagnosis::NextExperiment& next) {
    Json json = {{"description", diagnosis::describeRuns(next.runs)},
                 {"discriminates", next.discriminates},
                 {"resolves_sign", next.resolvesSign},
                 {"expected_power", next.power},
                 {"expected_conclusive", next.expectedConclusive}};
    Json runs = Json::array();
    for (const diagnosis::FurtherRun& r : next.runs)
        runs.push_back(furtherRunOf(r));
    for (const char* key : {"specimen_rotation", "drive", "repeats", "new_markers_arc_fraction"})
        json[key] = runs.front().at(key);
    json["runs"] = std::move(runs);
    return json;
}

Json noiseOf(const Diagnosis& d) {
    Json json = {{d.channel + "_std_" + d.unit, d.noise.total()}, {"white_std", d.noise.white},
                 {"correlated_std", d.noise.correlated},          {"correlation_time_s", d.noise.correlationTime},
                 {"excess_kurtosis", d.noise.excessKurtosis},     {"source", d.noise.source},
                 {"marker_std_mm", 1e3 * d.noise.marker}};
    for (const diagnosis::ChannelError& c : d.further)
        json[c.name + "_std_" + c.unit] = c.noise;
    return json;
}

Json fitOf(const Diagnosis& d) {
    const std::string unit = "_" + d.unit;
    const auto errors = [&](double training, double heldOut) {
        return Json{{"training_rmse" + unit, finite(training)}, {"heldout_rmse" + unit, finite(heldOut)}};
    };
    Json json = {{"baseline", errors(d.baselineTraining, d.baselineHeldOut)},
                 {"improved", errors(d.improvedTraining, d.improvedHeldOut)},
                 {"noise_floor_rmse" + unit, d.noise.total()},
                 {"improvement_ci90", {d.improvementCi.low, d.improvementCi.high}},
                 {"baseline_chi2_per_reading", finite(d.baselineChiSquaredPerReading)}};
    for (const diagnosis::ChannelError& c : d.further)
        json["channels"][c.name] = {
            {"baseline_training_rmse_" + c.unit, finite(c.baseline)},
            {"improved_training_rmse_" + c.unit, d.improved ? finite(c.improved) : finite(c.baseline)}};
    return json;
}

/// Forecasts of free runs from their beginnings.
Json forecastOf(const Diagnosis& d) {
    Json runs = Json::array();
    for (const diagnosis::RunForecast& run : d.forecast.runs)
        runs.push_back({{"run", run.run},
                        {"squares_per_reading", finite(run.squares)},
                        {"at_least", finite(run.atLeast)},
                        {"holds", run.holds}});
    return {{"runs", runs},
            {"forecasts", d.forecast.of},
            {"substituted", d.forecast.substituted},
            {"nonlinear", d.forecast.nonlinear}};
}

/// How far runs are explained without an effect.
Json validityOf(const Diagnosis& d) {
    const bool load = d.drive && d.drive->isLoad;
    const double factor = d.drive ? d.drive->perUnit : 1e3;
    const auto place = [&](const diagnosis::ValidRange::Place& p) {
        return Json{{"t_s", d.table ? Json(nullptr) : Json(p.time)},
                    {load ? "load" : "displacement_mm", factor * p.drive},
                    {"phase", diagnosis::name(p.phase)}};
    };
    Json runs = Json::array();
    for (const diagnosis::ValidRange& r : d.validity) {
        if (!r.known)
            continue;
        Json run = {{"run", r.run}, {"whole", r.whole}, {"explained_until", place(r.until)}};
        if (!r.whole) {
            run["departs"] = place(r.departs);
            run["departs_ci90"] = {place(r.departsFrom), place(r.departsTo)};
        }
        runs.push_back(run);
    }
    return runs;
}

Json homogeneityOf(const Diagnosis& d) {
    const diagnosis::Homogeneity& h = d.homogeneity;
    Json out = {{"shift", h.shift()}, {"p_value", h.p}, {"chi2", h.q}, {"degrees_of_freedom", h.degrees}};
    if (h.number.empty())
        return out;
    out["number"] = h.number;
    out["unit"] = h.unit;
    for (const auto& [run, value] : h.values)
        out["values"][run] = finite(value);
    return out;
}

Json nominalOf(const Diagnosis& d) {
    Json out = Json::object();
    for (const diagnosis::NominalResult& n : d.nominal) {
        out[n.name] = {{"stated", n.stated},
                       {"uncertainty", n.uncertainty},
                       {"fitted", n.fitted},
                       {"standardised_shift", n.standardisedShift},
                       {"unit", n.unit}};
        if (!n.prior.empty())
            out[n.name]["prior"] = n.prior;
    }
    return out;
}

/// Parameters that differ between specimens.
Json batchOf(const Diagnosis& d) {
    Json out = Json::object();
    for (const diagnosis::BatchResult& b : d.batch) {
        Json specimens = Json::object();
        for (const auto& [id, value] : b.specimens)
            specimens[id] = finite(value);
        out[b.name] = {{"common", finite(b.common)},
                       {"std", finite(b.std)},
                       {"std_ci90", {finite(b.ci90.low), finite(b.ci90.high)}},
                       {"std_is_prior", b.isPrior},
                       {"log_bayes_factor", finite(b.evidence)},
                       {"unit", b.unit},
                       {"merged_with", b.merged},
                       {"specimens", specimens}};
    }
    return out;
}

} // namespace

std::string diagnosisJson(const Diagnosis& d, const diagnosis::StoredFits& fits) {
    Json next = nullptr;
    if (d.next)
        next = nextOf(*d.next);
    Json json = {{"schema", "supercircle-diagnosis/2"},
                 {"verdict", d.verdict},
                 {"statement", d.statement},
                 {"probability_adequate", d.adequate},
                 {"probability_undetectable", d.undetectable()},
                 {"probability_outside_catalogue", d.outsideCatalogue},
                 {"misfit_p_value", d.misfit.p},
                 {"notes", d.notes},
                 {"noise", noiseOf(d)},
                 {"misfit_intervals", windowsOf(d.misfit, d)},
                 {"effects", effectsOf(d)},
                 {"wrong_numbers", numbersOf(d)},
                 {"screening", screeningOf(d)},
                 {"residual_after_best", windowsOf(d.residualAfterBest, d)},
                 {"learned_laws", learnedOf(d)},
                 {"fit", fitOf(d)},
                 {"nominal", nominalOf(d)},
                 {"homogeneity", homogeneityOf(d)},
                 {"next_experiment", next},
                 {"seed", d.seed},
                 {"forward_runs", d.forwardRuns},
                 {"timing", {{"elapsed_s", d.elapsed}, {"cpu_s", d.cpuSeconds}}}};
    if (!fits.fits.empty())
        json["replay"] = record::parseJson(storedFitsJson(fits));
    if (!d.batch.empty())
        json["batch"] = batchOf(d);
    if (!d.validity.empty())
        json["range_of_validity"] = validityOf(d);
    if (!d.forecast.runs.empty())
        json["forecast"] = forecastOf(d);
    return record::jsonText(json) + "\n";
}

} // namespace supercircle::cli
