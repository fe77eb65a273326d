// Friction from an observed transition between smooth and abrupt snaps, or from measured force curves.

#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/replay/experiment_input.h"
#include "plugin/cli/subcommands.h"

#include "bridge/box2d/lab_world.h"
#include "plugin/identification/calibration/curve.h"
#include "plugin/identification/calibration/switching.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/recording/table/files.h"
#include "plugin/recording/table/json_text.h"
#include "plugin/scene/loader/document.h"
#include "plugin/scene/loader/loader.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace supercircle::cli {

namespace {

using calibration::CriticalFriction;
using calibration::Snap;
using calibration::Trial;
using Json = nlohmann::ordered_json;

/// Adds a list of opening angles such as "0.75,0.8", all with one outcome; false if it is no such list.
bool addTrials(const std::string& text, Snap outcome, std::vector<Trial>& trials) {
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t to = std::min(text.find(',', from), text.size());
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
        if (error != std::errc{} || end != text.data() + to || !(value > 0.0 && value < 1.0))
            return false;
        trials.push_back({value, outcome});
        from = to + 1;
    }
    return true;
}

/// Simulates the scene at an opening angle and a friction coefficient, and returns the type of snap.
class SceneSimulation {
public:
    SceneSimulation(std::string text, std::string file, std::vector<scene::Override> fixed)
        : text_(std::move(text)), file_(std::move(file)), fixed_(std::move(fixed)) {}

    std::optional<Snap> operator()(double phiBar, double mu) {
        std::vector<scene::Override> overrides = fixed_;
        overrides.push_back({"phi_bar", phiBar});
        overrides.push_back({"mu", mu});
        std::vector<scene::Problem> problems;
        const auto scene = scene::loadText(text_, file_, overrides, problems);
        why.clear();
        for (const scene::Problem& p : problems)
            if (p.severity == scene::Problem::Severity::Error)
                why += p.toString() + "\n";
        std::shared_ptr<step::HostWorld> host = scene ? bridge::makeWorld(scene->rigid, why) : nullptr;
        if (!host)
            return std::nullopt;
        lab::RunOptions options;
        options.keepFrames = false;
        options.interrupt = &interrupted;
        const lab::RunResult out = lab::runScene(*scene, host, options);
        why = out.message;
        for (const auto& [key, value] : out.recording.summary)
            if (key == "snap_type" && out.status == lab::RunStatus::Done) {
                const auto* type = std::get_if<std::string>(&value);
                if (type != nullptr && *type != "none")
                    return *type == "II" ? Snap::Abrupt : Snap::Smooth;
            }
        if (why.empty())
            why = "the summary of the run has no snap_type";
        return std::nullopt;
    }
    std::string why; ///< why the last call gave no type

private:
    std::string text_, file_;
    std::vector<scene::Override> fixed_;
};

Json jsonOf(const std::optional<CriticalFriction>& c) {
    if (!c)
        return nullptr;
    return {{"phi_bar", c->phiBar},
            {"smooth_at_mu", c->below},
            {"abrupt_at_mu", std::isfinite(c->above) ? Json(c->above) : Json(nullptr)},
            {"simulations", c->simulations}};
}

int write(const CalibrateArguments& a, const Json& json) {
    if (a.out.empty())
        return kDone;
    const std::string error =
        record::writeAtomically(a.out, {{"calibration.json", record::jsonText(json) + "\n"}}).error();
    if (!error.empty())
        return complain(kCannotWrite, error);
    if (!a.quiet)
        std::printf("results: %s/calibration.json\n", a.out.c_str());
    return kDone;
}

int fromSwitch(const CalibrateArguments& a) {
    std::vector<Trial> trials;
    if (!addTrials(a.smooth, Snap::Smooth, trials) || !addTrials(a.abrupt, Snap::Abrupt, trials) || trials.empty())
        return complain(kBadInput, "calibrate: expected opening angles / 2 pi between 0 and 1 after --smooth and "
                                   "--abrupt, for example --smooth 0.75,0.83 --abrupt 0.85,0.9");
    std::vector<scene::Override> overrides;
    if (!readOverrides(a.parameters, overrides))
        return kBadInput;
    std::vector<scene::Problem> problems;
    const auto text = scene::readFile(a.file, problems);
    if (!text)
        return complain(kBadInput, problems.front().toString());
    if (!scene::loadText(*text, a.file, overrides, problems))
        return complain(kBadInput, scene::errorText(problems, 0));
    SceneSimulation simulation(*text, a.file, overrides);
    ProgressLine line(a.quiet);
    int runs = 0;
    const auto simulate = [&](double phiBar, double mu) {
        char words[80];
        std::snprintf(words, sizeof words, "opening angle %.3f, mu %.4f", phiBar, mu);
        line.show(std::min(0.95, ++runs / 26.0), words);
        return interrupted ? std::nullopt : simulation(phiBar, mu);
    };
    calibration::SwitchSettings settings;
    settings.angleUncertainty = a.angleUncertainty;
    settings.tolerance = a.tolerance;
    const auto result = calibration::frictionFromSwitch(trials, simulate, settings);
    line.clear();
    if (interrupted)
        return complain(kInterrupted, "interrupted");
    if (!result)
        return complain(simulation.why.empty() ? kBadInput : kCannotGoOn,
                        a.file + ": " + result.error() + (simulation.why.empty() ? "" : " (" + simulation.why + ")"));
    const auto& r = *result;
    if (std::isfinite(r.high))
        std::printf("friction coefficient: %.3f to %.3f\n", r.low, r.high);
    else
        std::printf("friction coefficient: at least %.3f\n", r.low);
    if (r.fromAbrupt)
        std::printf("  abrupt at %.4f: the transition of this angle is at mu = %.4f to %.4f\n", r.fromAbrupt->phiBar,
                    r.fromAbrupt->below, r.fromAbrupt->above);
    if (r.fromSmooth)
        std::printf("  smooth at %.4f: the transition of this angle is at mu = %.4f to %.4f\n", r.fromSmooth->phiBar,
                    r.fromSmooth->below, r.fromSmooth->above);
    if (r.low > r.high)
        std::printf("  no coefficient fits: the angles are less certain than stated, or the shells differ\n");
    const Json json = {{"method", "switch"},
                       {"scene", a.file},
                       {"friction", {{"low", r.low}, {"high", std::isfinite(r.high) ? Json(r.high) : Json(nullptr)}}},
                       {"angle_uncertainty", a.angleUncertainty},
                       {"from_abrupt", jsonOf(r.fromAbrupt)},
                       {"from_smooth", jsonOf(r.fromSmooth)}};
    const int code = write(a, json);
    return code != kDone ? code : printed() ? kDone : kCannotWrite;
}

int fromCurve(const CalibrateArguments& a) {
    if (!a.smooth.empty() || !a.abrupt.empty() || !a.parameters.empty())
        return complain(kBadInput, a.file + ": this is an experiment; --smooth, --abrupt and --param go with a scene");
    const auto loaded = loadExperiment(a.file, a.quiet, a.channel);
    if (!loaded)
        return kBadInput;
    ProgressLine line(a.quiet);
    calibration::CurveSettings settings;
    settings.jobs = a.jobs;
    settings.interrupt = &interrupted;
    settings.progress = [&](double fraction, const std::string& words) { line.show(fraction, words); };
    const calibration::CurveResult r = calibration::frictionFromCurve(*loaded, settings);
    line.clear();
    if (r.stopped)
        return complain(kInterrupted, "interrupted");
    if (!r.failure.empty())
        return complain(kCannotGoOn, a.file + ": " + r.failure);
    std::printf("friction coefficient: %.4f, 90 %% interval %.4f to %.4f\n", r.friction, r.low, r.high);
    std::printf("  chi-squared per reading: %.2f (noise %.3g N); %zu simulated runs\n", r.chiSquaredPerReading, r.noise,
                r.simulations);
    if (r.chiSquaredPerReading > 1.5)
        std::printf("  the model without extra physics does not explain these readings; run `supercircle diagnose`\n");
    Json others = Json::object();
    for (const auto& [name, value] : r.others)
        others[name] = value;
    const Json json = {{"method", "curve"},
                       {"experiment", a.file},
                       {"friction", {{"value", r.friction}, {"low", r.low}, {"high", r.high}, {"confidence", 0.9}}},
                       {"chi2_per_reading", r.chiSquaredPerReading},
                       {"noise_N", r.noise},
                       {"other_parameters", others},
                       {"simulations", r.simulations}};
    const int code = write(a, json);
    return code != kDone ? code : printed() ? kDone : kCannotWrite;
}

} // namespace

int calibrate(const CalibrateArguments& a) {
    OutputFolder folder(a.out); // before simulations that take minutes
    if (const std::string error = a.out.empty() ? std::string() : folder.prepare(); !error.empty())
        return complain(kCannotWrite, error);
    return schemaOf(a.file).rfind("rod-recordings/", 0) == 0 ? fromCurve(a) : fromSwitch(a);
}

} // namespace supercircle::cli
