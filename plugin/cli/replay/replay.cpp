#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/replay/experiment_input.h"
#include "plugin/cli/replay/taken_fit.h"
#include "plugin/cli/subcommands.h"
#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/replay/stored_fit.h"
#include "plugin/pages/replay/replay_page.h"

#include "plugin/recording/experiment/load.h"
#include "plugin/recording/table/csv.h"
#include "plugin/recording/table/json_text.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

using Json = nlohmann::ordered_json;
using record::NamedText;

/// Sets resolution, parameters and effects; false after a message.
bool prepare(const ReplayArguments& a, Replay& out) {
    out.parameters = replay::nominal(out.experiment);
    out.resolution = a.coarse ? replay::Resolution::coarse() : replay::Resolution::fine();
    if (a.elements > 0)
        out.resolution.elements = a.elements;
    if (!takeFit(a, out))
        return false;
    std::vector<scene::Override> overrides;
    if (!readOverrides(a.parameters, overrides))
        return false;
    for (const scene::Override& o : overrides)
        if (const std::string why = replay::set(out.parameters, out.experiment, o.name, o.value); !why.empty()) {
            std::fprintf(stderr, "--param %s=%.10g: %s\n", o.name.c_str(), o.value, why.c_str());
            return false;
        }
    for (const std::string& text : a.effects)
        if (const std::string why = effects::add(out.parameters.effects, text); !why.empty()) {
            std::fprintf(stderr, "--effect %s: %s\n", text.c_str(), why.c_str());
            return false;
        }
    if (const std::string why = replay::checkEffects(out.parameters, out.experiment); !why.empty()) {
        std::fprintf(stderr, "--effect: %s\n", why.c_str());
        return false;
    }
    return true;
}

/// Parameters of the active effects, by key.
Json effectsOn(const replay::Parameters& parameters) {
    Json out = Json::object();
    for (const effects::Setting& s : parameters.effects) {
        const effects::Effect& effect = effects::catalog()[static_cast<std::size_t>(s.key)];
        if (effects::isOff(s))
            continue;
        out[effect.name] = replay::jsonOf(s);
    }
    return out;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
    for (double& v : values)
        v *= factor;
    return values;
}

/// Adds NAME_replay.csv, and NAME_replay_markers.csv where markers were tracked.
std::string addTables(const experiment::Experiment& e, const experiment::Run& run, const ReplayedRun& done,
                      std::vector<NamedText>& files) {
    const auto put = [&](const std::string& name, const record::Series& series) {
        auto text = record::csvText(series);
        if (text)
            files.emplace_back(name, *std::move(text));
        return text.error();
    };
    std::vector<double> simulated = done.simulated.readings.force;
    simulated.resize(run.readings.time.size(), std::numeric_limits<double>::quiet_NaN());
    record::Series force;
    const experiment::Channel& c = experiment::channel(e);
    const std::string name = c.name, unit = std::string("_") + c.unit;
    force.names = {"time_s", name + "_recorded" + unit, name + "_simulated" + unit, "residual" + unit};
    force.columns = {run.readings.time, scaled(run.readings.force, c.perUnit), scaled(simulated, c.perUnit),
                     scaled(done.comparison.residual, c.perUnit)};
    if (!experiment::isFree(e)) {
        force.names.insert(force.names.begin() + 1, "displacement_mm");
        force.columns.insert(force.columns.begin() + 1, scaled(run.readings.displacement, 1e3));
    }
    if (const std::string why = put(done.name + "_replay.csv", force); !why.empty())
        return why;
    if (done.simulated.markers.x.empty() || done.simulated.markers.time.empty())
        return {};
    record::Series tracks;
    tracks.names = {"time_s"};
    tracks.columns = {done.simulated.markers.time};
    for (std::size_t m = 0; m < e.markers.size(); ++m) {
        tracks.names.insert(tracks.names.end(), {e.markers[m].name + "_x_mm", e.markers[m].name + "_y_mm"});
        tracks.columns.push_back(scaled(done.simulated.markers.x[m], 1e3));
        tracks.columns.push_back(scaled(done.simulated.markers.y[m], 1e3));
    }
    return put(done.name + "_replay_markers.csv", tracks);
}

Json landmark(const replay::Landmark& l) {
    return {
        {"time_s", l.time}, {"displacement_mm", 1e3 * l.displacement}, {"before_N", l.before}, {"after_N", l.after}};
}

/// Errors of a run of a free scene, in the unit of its channel.
Json freeSummaryOf(const ReplayedRun& run, const experiment::Channel& channel) {
    const replay::Comparison& c = run.comparison;
    const std::string unit = std::string("_") + channel.unit;
    return {{"run", run.name},
            {"failure", run.simulated.failure.empty() ? Json(nullptr) : Json(run.simulated.failure)},
            {"peak_recorded" + unit, channel.perUnit * c.peakRecorded},
            {"peak_simulated" + unit, channel.perUnit * c.peakSimulated},
            {"rmse" + unit, channel.perUnit * c.rmseAll},
            {"residual_mean" + unit, channel.perUnit * c.residualMean},
            {"max_error" + unit, channel.perUnit * c.maxError},
            {"max_error_at_s", c.maxErrorAt},
            {"steps", run.simulated.steps},
            {"cpu_s", run.simulated.cpuSeconds}};
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
    const diagnosis::LawScore& s = *taken.score;
    json["without"] = {{"training_rmse" + unit, s.rmseWithout}, {"heldout_rmse" + unit, s.heldOutWithout}};
    json["with"] = {{"training_rmse" + unit, s.rmseWith}, {"heldout_rmse" + unit, s.heldOutWith}};
    json["heldout_gain"] = s.gain;
    json["heldout_gain_error"] = s.gainError;
    return json;
}

std::string summary(const Replay& replay) {
    Json parameters = Json::object(), runs = Json::array();
    for (const replay::ParameterInfo& info : replay::parameterList(replay.experiment))
        parameters[info.name] = replay::get(replay.parameters, replay.experiment, info.name).value_or(0.0);
    for (const ReplayedRun& run : replay.runs)
        runs.push_back(replay.experiment.scene ? freeSummaryOf(run, experiment::channel(replay.experiment))
                                               : summaryOf(run));
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

void simulateRuns(Replay& replay, bool quiet) {
    ProgressLine line(quiet);
    const std::size_t count = replay.experiment.runs.size();
    const std::vector<std::string> names = experiment::runNames(replay.experiment, false);
    for (std::size_t k = 0; k < count && !interrupted; ++k) {
        const experiment::Run& run = replay.experiment.runs[k];
        replay::Options options;
        options.interrupt = &interrupted;
        options.progress = [&](double fraction) {
            line.show((static_cast<double>(k) + fraction) / static_cast<double>(count),
                      "run " + std::to_string(k + 1) + " of " + std::to_string(count));
        };
        ReplayedRun done{names[k], {}, {}};
        done.simulated = replay::simulate(replay.experiment, k, replay.parameters, replay.resolution, options);
        done.comparison =
            replay::compare(run, done.simulated, replay::ExclusionWindow{}.in(replay::naturalUnits(replay.experiment)),
                            !experiment::isFree(replay.experiment));
        replay.runs.push_back(std::move(done));
    }
    line.clear();
}

std::string writeAll(const Replay& replay, const std::string& folder) {
    std::vector<NamedText> files = {{"replay.json", summary(replay)}};
    for (std::size_t k = 0; k < replay.runs.size(); ++k)
        if (const std::string why = addTables(replay.experiment, replay.experiment.runs[k], replay.runs[k], files);
            !why.empty())
            return why;
    auto pages = replayPages(replay);
    if (!pages)
        return pages.error();
    std::move(pages->begin(), pages->end(), std::back_inserter(files));
    return record::writeAtomically(folder, files).error();
}

void print(const Replay& replay, const std::string& folder) {
    const double k = experiment::channel(replay.experiment).perUnit;
    const char* const unit = experiment::channel(replay.experiment).unit.c_str();
    for (const ReplayedRun& run : replay.runs) {
        const replay::Comparison& c = run.comparison;
        std::printf("%s: peak %.4g %s recorded, %.4g %s simulated; rms error %.3g %s (%.2f %%), largest %.3g %s",
                    run.name.c_str(), k * c.peakRecorded, unit, k * c.peakSimulated, unit, k * c.rmse, unit,
                    100.0 * c.rmse / std::max(c.peakRecorded, 1e-300), k * c.maxError, unit);
        for (const auto& [i, j] : c.matches)
            std::printf("; jump at %.3f mm recorded, %.3f mm simulated", 1e3 * c.recorded[i].displacement,
                        1e3 * c.simulated[j].displacement);
        std::printf("\n");
    }
    if (replay.taken && replay.taken->carried) {
        const TakenFit& t = *replay.taken;
        for (const std::string& note : t.notes)
            std::printf("%s\n", note.c_str());
        if (t.score)
            std::printf(
                "%s, carried: with the stated numbers fitted, the held-out error is %.3g %s without the law and "
                "%.3g %s with it (gain %.1f +- %.1f)\n",
                t.label.c_str(), t.score->heldOutWithout, unit, t.score->heldOutWith, unit, t.score->gain,
                t.score->gainError);
        else
            std::printf("%s, carried: no score, %s\n", t.label.c_str(), t.failure.c_str());
    }
    std::printf("results: %s/replay.json, run files; pictures: %s/replay.html\n", folder.c_str(), folder.c_str());
}

} // namespace

int replay(const ReplayArguments& a) {
    auto loaded = loadExperiment(a.file, a.quiet);
    Replay replay;
    if (!loaded)
        return kBadInput;
    replay.experiment = std::move(*loaded);
    if (!prepare(a, replay))
        return kBadInput;
    OutputFolder folder(resultsFolder(a.file, a.out, "replay"));
    if (const std::string error = folder.prepare(); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    simulateRuns(replay, a.quiet);
    scoreCarriedLaw(replay, a.quiet);
    if (const std::string error = writeAll(replay, folder.path()); !error.empty()) {
        std::fprintf(stderr, "%s\n", error.c_str());
        return kCannotWrite;
    }
    if (!a.quiet)
        print(replay, folder.path());
    const bool arrived = printed();
    if (interrupted) {
        std::fprintf(stderr, "interrupted; what is done is in %s\n", folder.path().c_str());
        return kInterrupted;
    }
    for (const ReplayedRun& run : replay.runs)
        if (!run.simulated.failure.empty()) {
            std::fprintf(stderr, "%s could not go on: %s; what is done is in %s\n", run.name.c_str(),
                         run.simulated.failure.c_str(), folder.path().c_str());
            return kCannotGoOn;
        }
    return arrived ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
