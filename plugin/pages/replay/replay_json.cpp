#include "plugin/pages/replay/replay_page.h"

#include "plugin/identification/replay/free_scales.h"
#include "plugin/recording/table/json_text.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Parameters of the active effects, by key.
Json effectsOn(const replay::Parameters& parameters) {
    Json out = Json::object();
    for (const effects::Setting& s : parameters.effects) {
        const effects::Effect& effect = effects::catalog()[static_cast<std::size_t>(s.key)];
        if (effects::isOff(s))
            continue;
        Json& one = out[effect.name + (s.channel.empty() ? "" : "." + s.channel)];
        one["shell"] = s.shell;
        for (std::size_t i = 0; i < effect.parameters.size(); ++i)
            if (const effects::Parameter& p = effect.parameters[i]; !p.choices.empty())
                one[p.name] = p.choices[static_cast<std::size_t>(s.values[i])];
            else if (std::isfinite(s.values[i]))
                one[p.name] = s.values[i];
    }
    return out;
}

Json landmark(const replay::Landmark& l) {
    return {
        {"time_s", l.time}, {"displacement_mm", 1e3 * l.displacement}, {"before_N", l.before}, {"after_N", l.after}};
}

/// Errors of a run of a free scene, in the unit of its channel.
Json freeSummaryOf(const ReplayedRun& run, const experiment::Experiment& e) {
    const experiment::Channel& channel = experiment::channel(e);
    const replay::Comparison& c = run.comparison;
    const std::string unit = std::string("_") + channel.unit;
    Json json = {{"run", run.name},
                 {"failure", run.simulated.failure.empty() ? Json(nullptr) : Json(run.simulated.failure)},
                 {"peak_recorded" + unit, channel.perUnit * c.peakRecorded},
                 {"peak_simulated" + unit, channel.perUnit * c.peakSimulated},
                 {"rmse" + unit, channel.perUnit * c.rmseAll},
                 {"residual_mean" + unit, channel.perUnit * c.residualMean},
                 {"max_error" + unit, channel.perUnit * c.maxError},
                 {"max_error_at_s", c.maxErrorAt},
                 {"steps", run.simulated.steps},
                 {"cpu_s", run.simulated.cpuSeconds}};
    for (std::size_t i = 0; i < c.further.size(); ++i) {
        const experiment::Channel& own = experiment::furtherChannels(e)[i].channel;
        const replay::ChannelComparison& errors = c.further[i];
        json["channels"][own.name] = {{"peak_recorded_" + own.unit, own.perUnit * errors.peakRecorded},
                                      {"peak_simulated_" + own.unit, own.perUnit * errors.peakSimulated},
                                      {"rmse_" + own.unit, own.perUnit * errors.rmse},
                                      {"max_error_" + own.unit, own.perUnit * errors.maxError},
                                      {"max_error_at_s", errors.maxErrorAt}};
    }
    return json;
}

Json summaryOf(const ReplayedRun& run) {
    const replay::Comparison& c = run.comparison;
    Json pairs = Json::array(), recordedOnly = Json::array(), simulatedOnly = Json::array();
    std::vector<char> usedA(c.recorded.size(), 0), usedB(c.simulated.size(), 0);
    for (const auto& [i, j] : c.matches) {
        pairs.push_back({{"recorded", landmark(c.recorded[i])}, {"simulated", landmark(c.simulated[j])}});
        usedA[i] = usedB[j] = 1;
    }
    for (std::size_t i = 0; i < usedA.size(); ++i)
        if (!usedA[i])
            recordedOnly.push_back(landmark(c.recorded[i]));
    for (std::size_t j = 0; j < usedB.size(); ++j)
        if (!usedB[j])
            simulatedOnly.push_back(landmark(c.simulated[j]));
    Json json = {{"run", run.name},
                 {"failure", run.simulated.failure.empty() ? Json(nullptr) : Json(run.simulated.failure)},
                 {"peak_recorded_N", c.peakRecorded},
                 {"peak_simulated_N", c.peakSimulated},
                 {"rmse_N", c.rmse},
                 {"residual_mean_N", c.residualMean},
                 {"rmse_about_mean_N", c.rmseAboutMean},
                 {"max_error_N", c.maxError},
                 {"max_error_at_s", c.maxErrorAt},
                 {"rmse_with_landmarks_N", c.rmseAll},
                 {"excluded_fraction", c.excludedFraction},
                 {"landmarks", pairs},
                 {"landmarks_recorded_only", recordedOnly},
                 {"landmarks_simulated_only", simulatedOnly},
                 {"force_zero_N", run.simulated.forceZero},
                 {"steps", run.simulated.steps},
                 {"unconverged_steps", run.simulated.unconverged},
                 {"cpu_s", run.simulated.cpuSeconds}};
    if (!run.simulated.markers.time.empty()) {
        json["marker_rmse_mm"] = 1e3 * c.markerRmse;
        json["marker_max_error_mm"] = 1e3 * c.markerMax;
    }
    return json;
}

/// Where parameters and effects come from.
Json takenOf(const TakenFit& taken, const experiment::Channel& channel) {
    Json json = {{"diagnosis", taken.file}, {"label", taken.label}};
    if (!taken.carried)
        return json;
    const std::string unit = std::string("_") + channel.unit;
    json["notes"] = taken.notes;
    if (!taken.score)
        return json;
    const replay::LawScore& s = *taken.score;
    json["without"] = {{"training_rmse" + unit, s.rmseWithout}, {"heldout_rmse" + unit, s.heldOutWithout}};
    json["with"] = {{"training_rmse" + unit, s.rmseWith}, {"heldout_rmse" + unit, s.heldOutWith}};
    json["heldout_gain"] = s.gain;
    json["heldout_gain_error"] = s.gainError;
    return json;
}

} // namespace

std::string replayJson(const Replay& replay) {
    Json parameters = Json::object(), runs = Json::array();
    for (const replay::ParameterInfo& info : replay::parameterList(replay.experiment))
        parameters[info.name] = replay::get(replay.parameters, replay.experiment, info.name).value_or(0.0);
    for (const ReplayedRun& run : replay.runs)
        runs.push_back(replay.experiment.scene ? freeSummaryOf(run, replay.experiment) : summaryOf(run));
    const experiment::NaturalUnits units = replay::naturalUnits(replay.experiment);
    const replay::ExclusionWindow w = replay::ExclusionWindow{}.in(units);
    Json json = {{"experiment", replay.experiment.file},
                 {"protocol", experiment::name(replay.experiment.protocol)},
                 {"elements", replay.resolution.elements},
                 {"position_tolerance_m", replay.resolution.in(units).positionTolerance},
                 {"parameters", parameters},
                 {"effects", effectsOn(replay.parameters)},
                 {"excluded_before_landmark_s", w.before},
                 {"excluded_after_landmark_s", w.after},
                 {"runs", runs}};
    if (replay.taken)
        json[replay.taken->carried ? "carried" : "with"] =
            takenOf(*replay.taken, experiment::channel(replay.experiment));
    return record::jsonText(json) + "\n";
}

} // namespace supercircle::cli
