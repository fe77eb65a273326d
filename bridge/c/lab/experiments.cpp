// Recorded experiments: import, replay, diagnosis.

#include "bridge/c/lab/request.h"
#include "plugin/identification/diagnosis/carried_score.h"
#include "plugin/identification/diagnosis/diagnose.h"
#include "plugin/identification/diagnosis/own_law.h"
#include "plugin/identification/diagnosis/replay_model.h"
#include "plugin/identification/diagnosis/stored_fits.h"
#include "plugin/identification/replay/compare.h"
#include "plugin/identification/replay/free_scales.h"
#include "plugin/identification/replay/parameters.h"
#include "plugin/identification/replay/simulate.h"
#include "plugin/pages/diagnosis/diagnose_page.h"
#include "plugin/pages/diagnosis/ensemble_file.h"
#include "plugin/pages/diagnosis/stored_fits_json.h"
#include "plugin/pages/replay/replay_page.h"
#include "plugin/recording/experiment/load.h"
#include "plugin/recording/import/specimen_file.h"
#include "plugin/recording/import/template.h"
#include "supercircle/effects/effect.h"
#include "supercircle/step/parallel.h"
#include "supercircle/support/names.h"

#include <chrono>
#include <ctime>

using namespace supercircle::c;
namespace cli = supercircle::cli;
namespace diagnosis = supercircle::diagnosis;
namespace effects = supercircle::effects;
namespace experiment = supercircle::experiment;
namespace importing = supercircle::importing;
namespace replay = supercircle::replay;
namespace scene = supercircle::scene;
namespace step = supercircle::step;

namespace {

experiment::Experiment experimentOf(const Request& r, Json& notes) {
    const std::string file = r.text("file");
    if (file.empty())
        refuse(SC_BAD_INPUT, "the request needs a \"file\": the experiment.json beside its recordings");
    std::vector<scene::Problem> problems;
    auto loaded = experiment::load(file, problems);
    if (!loaded)
        refuse(SC_BAD_INPUT, loaded.error());
    notes = Json::array();
    for (const scene::Problem& p : problems)
        notes.push_back(p.toString());
    return *std::move(loaded);
}

cli::Replay prepared(const Request& r, Json& notes) {
    cli::Replay out;
    out.experiment = experimentOf(r, notes);
    out.parameters = replay::nominal(out.experiment);
    const std::string fidelity = r.text("fidelity", "fine");
    if (fidelity != "coarse" && fidelity != "fine")
        refuse(SC_BAD_INPUT, "\"fidelity\" of the request: expected \"coarse\" or \"fine\"");
    out.resolution = fidelity == "coarse" ? replay::Resolution::coarse() : replay::Resolution::fine();
    out.resolution.elements = static_cast<int>(r.integer("elements", out.resolution.elements, 3, 4096));
    const std::string with = r.text("with"), carry = r.text("carry");
    if (!with.empty() && !carry.empty())
        refuse(SC_BAD_INPUT, "the request has both \"with\" and \"carry\"; give one of them");
    if (const std::string file = with + carry; !file.empty()) {
        const bool carried = with.empty();
        const auto taken = cli::takeFit(file, r.text("label"), carried, out.experiment, out.parameters);
        if (!taken)
            refuse(SC_BAD_INPUT, taken.error());
        out.taken = cli::TakenFit{file, taken->label, carried, taken->notes, std::nullopt, {}};
    }
    for (const auto& [name, value] : r.numbers("parameters"))
        if (const std::string why = replay::set(out.parameters, out.experiment, name, value); !why.empty())
            refuse(SC_BAD_INPUT, name + ": " + why);
    if (const std::string why = diagnosis::addEffects(r.texts("effects"), out.experiment, out.parameters); !why.empty())
        refuse(SC_BAD_INPUT, why);
    return out;
}

void simulateRuns(cli::Replay& all, Watch& watch) {
    const std::size_t count = all.experiment.runs.size();
    const std::vector<std::string> names = experiment::runNames(all.experiment, false);
    for (std::size_t k = 0; k < count && !watch.cancelled(); ++k) {
        replay::Options options;
        options.interrupt = &watch.cancelled();
        options.progress = [&](double fraction) {
            watch.tell((static_cast<double>(k) + fraction) / static_cast<double>(count),
                       "run " + std::to_string(k + 1) + " of " + std::to_string(count));
        };
        cli::ReplayedRun run{names[k], {}, {}};
        run.simulated = replay::simulate(all.experiment, k, all.parameters, all.resolution, options);
        run.comparison = replay::compare(all.experiment.runs[k], run.simulated,
                                         replay::ExclusionWindow{}.in(replay::naturalUnits(all.experiment)),
                                         !experiment::isFree(all.experiment));
        all.runs.push_back(std::move(run));
    }
}

/// Recorded and simulated readings of each run and channel, in the unit of the channel.
Json curvesJson(const cli::Replay& all) {
    Json out = Json::array();
    const auto add = [&](std::size_t k, const experiment::Channel& channel, const std::vector<double>& recorded,
                         const std::vector<double>& simulated) {
        const auto inUnit = [&](std::vector<double> values) {
            for (double& v : values)
                v *= channel.perUnit;
            return numbersJson(values);
        };
        out.push_back({{"run", all.runs[k].name},
                       {"channel", channel.name},
                       {"unit", channel.unit},
                       {"time_s", numbersJson(all.experiment.runs[k].readings.time)},
                       {"displacement_m", numbersJson(all.experiment.runs[k].readings.displacement)},
                       {"recorded", inUnit(recorded)},
                       {"simulated", inUnit(simulated)}});
    };
    for (std::size_t k = 0; k < all.runs.size(); ++k) {
        const experiment::Readings &recorded = all.experiment.runs[k].readings,
                                   &simulated = all.runs[k].simulated.readings;
        add(k, experiment::channel(all.experiment), recorded.force, simulated.force);
        for (std::size_t c = 0; c < recorded.further.size() && c < simulated.further.size(); ++c)
            add(k, experiment::furtherChannels(all.experiment)[c].channel, recorded.further[c], simulated.further[c]);
    }
    return out;
}

void scoreCarriedLaw(cli::Replay& all, Watch& watch) {
    if (!all.taken || !all.taken->carried || watch.cancelled())
        return;
    const auto score = diagnosis::scoreOfLaw(all.experiment, all.parameters.effects, &watch.cancelled());
    all.taken->failure = score.error();
    if (score)
        all.taken->score = *score;
}

/// Laws of the user that compete with the catalogue.
std::vector<diagnosis::StartedLaw> lawsOf(const Request& r) {
    std::vector<std::string> texts = r.texts("effects");
    std::vector<diagnosis::StartedLaw> laws;
    if (const std::string why = diagnosis::takeOwnLaws(texts, laws); !why.empty())
        refuse(SC_BAD_INPUT, why);
    if (!texts.empty())
        refuse(SC_BAD_INPUT, "\"effects\" of the request: " + texts.front() + " is no law of your own, NAME:FORMULA");
    return laws;
}

diagnosis::Diagnosis diagnoseAll(const Request& r, const experiment::Experiment& e, Watch& watch,
                                 diagnosis::StoredFits& fits) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const double minutes = r.number("time_limit_min", 10.0);
    diagnosis::ReplayModel model(e, r.texts("without"), &watch.cancelled());
    for (const diagnosis::StartedLaw& law : lawsOf(r))
        if (const std::string why = model.add(law); !why.empty())
            refuse(SC_BAD_INPUT, why);
    diagnosis::Diagnosis found;
    found.stopped = watch.cancelled();
    if (found.stopped) // the model is incomplete
        return found;
    diagnosis::SimulationCache cache;
    if (const std::string file = r.text("cache"); !file.empty())
        if (const std::string why = cache.open(file, model.identity()); !why.empty())
            refuse(SC_BAD_INPUT, why);
    const auto end = begin + std::chrono::duration<double>(60.0 * minutes);
    diagnosis::Evaluator evaluator(model, e.runs.size(),
                                   step::threadLoop(static_cast<int>(r.integer("jobs", 0, 0, 256))), cache,
                                   &watch.cancelled(), [=] { return minutes > 0.0 && Clock::now() >= end; });
    diagnosis::DiagnosisSettings settings;
    settings.seed = static_cast<std::uint64_t>(r.integer("seed", 1, 0, std::int64_t{1} << 53));
    settings.nextExperiment = r.flag("next_experiment", true);
    settings.progress = [&](double fraction, const std::string& stage) { watch.tell(fraction, stage); };
    found = diagnosis::diagnose(diagnosis::recordedDataOf(e), evaluator, settings);
    found.elapsed = std::chrono::duration<double>(Clock::now() - begin).count();
    found.cpuSeconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
    if (!found.stopped && found.failure.empty())
        fits = diagnosis::storedFitsOf(model, e, found);
    return found;
}

/// Answers a request whose file compares ensembles; nothing for experiments.
std::optional<Json> ensemblesAnswer(const Request& r) {
    const std::string file = r.text("file");
    if (file.empty())
        return std::nullopt;
    std::vector<scene::Problem> problems;
    const auto request = cli::readEnsembles(file, problems);
    if (!request)
        return std::nullopt;
    if (scene::anyError(problems))
        refuse(SC_BAD_INPUT, scene::errorText(problems));
    if (!r.texts("effects").empty())
        refuse(SC_BAD_INPUT, "\"effects\" of the request: a law of your own needs an experiment");
    const auto seed = static_cast<std::uint64_t>(r.integer("seed", 1, 0, std::int64_t{1} << 53));
    const diagnosis::EnsembleDiagnosis d =
        diagnosis::diagnoseEnsembles(request->quantities, request->recorded, request->nominal, request->effects, seed);
    if (!d.failure.empty())
        refuse(SC_BAD_INPUT, file + ": " + d.failure);
    Json notes = Json::array();
    for (const scene::Problem& p : problems)
        notes.push_back(p.toString());
    return Json{
        {"status", "done"}, {"message", ""}, {"notes", notes}, {"diagnosis", Json::parse(cli::ensembleJson(d, seed))}};
}

void requireDiagnosable(const Request& r, const experiment::Experiment& e) {
    if (const std::string why = diagnosis::tooFewReadings(e); !why.empty())
        refuse(SC_BAD_INPUT, why);
    std::vector<std::string> known;
    for (const effects::Effect& effect : effects::catalog())
        known.push_back(effect.name);
    for (const std::string& label : r.texts("without"))
        if (effects::find(label) == nullptr)
            refuse(SC_BAD_INPUT,
                   "\"without\" of the request: there is no effect " + label + supercircle::didYouMean(label, known));
}

int signOf(const Request& r, const char* key) {
    const std::string word = r.text(key);
    if (word.empty() || word == "positive" || word == "negative")
        return word.empty() ? 0 : word == "positive" ? 1 : -1;
    refuse(SC_BAD_INPUT, std::string("\"") + key + "\" of the request: expected \"positive\" or \"negative\"");
}

importing::Hints hintsOf(const Request& r) {
    importing::Hints hints;
    hints.encoding = importing::encodingOf(r.text("encoding"));
    hints.columns = r.texts("columns");
    for (const std::string& text : r.texts("units")) {
        hints.units.push_back(importing::unitOf(text));
        if (hints.units.back().measures == importing::Quantity::None)
            refuse(SC_BAD_INPUT, "\"units\" of the request: \"" + text + "\" is no unit");
    }
    hints.rate = r.number("rate_Hz", 0.0);
    hints.speed = r.number("speed_m_s", 0.0);
    hints.driveTolerance = r.number("tolerance_m", 0.0);
    hints.displacementSign = signOf(r, "displacement");
    hints.forceSign = signOf(r, "force");
    hints.fromTurningPoint = static_cast<int>(r.integer("from_turning_point", 0, 0, 1000000));
    hints.average = static_cast<int>(r.integer("average", 1, 1, 1000000));
    const auto set = [&](const char* key) {
        const std::vector<std::string> all = r.texts(key);
        return std::set<std::string>(all.begin(), all.end());
    };
    hints.accept = set("accept");
    hints.cut = set("cut");
    hints.keep = set("keep");
    const std::string zero = r.text("force_zero"), specimen = r.text("specimen");
    if (!zero.empty() || !specimen.empty())
        hints.forceZero = done(zero.empty() ? importing::statedForceZero(specimen) : importing::parseForceZero(zero));
    return hints;
}

Json importedJson(const importing::Imported& imported, const importing::Description& d) {
    const auto runs = importing::runFiles(imported);
    Json files = Json::object();
    for (const supercircle::record::NamedText& file : done(runs))
        files[file.first] = file.second;
    for (const supercircle::record::NamedText& file : d.files)
        files[file.first] = file.second;
    files["experiment.json"] = d.json;
    return {{"status", "done"},
            {"worst", importing::worst(imported)},
            {"account", importing::account(imported)},
            {"details", Json::parse(importing::accountJson(imported, d))},
            {"assumed", d.assumed},
            {"missing", d.todo},
            {"files", files}};
}

} // namespace

const char* sc_lab_import(const char* request, sc_lab_progress progress, void* context) {
    return answer([&] {
        const Request r(
            request,
            {"files",   "texts",   "protocol",  "specimen",    "scene_file",   "encoding", "columns",
             "units",   "rate_Hz", "speed_m_s", "tolerance_m", "displacement", "force",    "from_turning_point",
             "average", "accept",  "cut",       "keep",        "force_zero",   "content"});
        const supercircle::TextsInMemory content(r.content());
        const importing::Hints hints = hintsOf(r);
        const std::vector<std::string> files = r.texts("files");
        std::vector<supercircle::record::NamedText> texts;
        const std::vector<std::string> given = r.texts("texts");
        for (const std::string& text : given)
            texts.emplace_back("export_" + std::to_string(texts.size() + 1), text);
        if (files.empty() == texts.empty())
            refuse(SC_BAD_INPUT, "the request needs either \"files\" (paths) or \"texts\" (their content)");
        return watched(progress, context, [&](Watch&) {
            const auto imported =
                files.empty() ? importing::readTexts(texts, hints) : importing::readExports(files, hints);
            const auto description =
                importing::describe(done(imported), {r.text("protocol"), r.text("specimen"), r.text("scene_file")});
            return importedJson(*imported, done(description));
        });
    });
}

const char* sc_lab_replay(const char* request, sc_lab_progress progress, void* context) {
    return answer([&] {
        const Request r(request,
                        {"file", "parameters", "effects", "with", "carry", "label", "elements", "fidelity", "content"});
        const supercircle::TextsInMemory content(r.content());
        Json notes;
        cli::Replay all = prepared(r, notes);
        return watched(progress, context, [&](Watch& watch) {
            simulateRuns(all, watch);
            scoreCarriedLaw(all, watch);
            std::string failure;
            for (const cli::ReplayedRun& run : all.runs)
                if (failure.empty() && !run.simulated.failure.empty())
                    failure = run.name + ": " + run.simulated.failure;
            return Json{{"status", watch.cancelled() ? "cancelled"
                                   : failure.empty() ? "done"
                                                     : "failed"},
                        {"message", failure},
                        {"notes", notes},
                        {"replay", Json::parse(cli::replayJson(all))},
                        {"curves", curvesJson(all)}};
        });
    });
}

const char* sc_lab_diagnose(const char* request, sc_lab_progress progress, void* context) {
    return answer([&] {
        const Request r(request, {"file", "jobs", "seed", "effects", "without", "time_limit_min", "next_experiment",
                                  "cache", "content"});
        const supercircle::TextsInMemory content(r.content());
        if (const auto ensembles = ensemblesAnswer(r))
            return watched(progress, context, [&](Watch&) { return *ensembles; });
        Json notes;
        const experiment::Experiment e = experimentOf(r, notes);
        requireDiagnosable(r, e);
        (void)lawsOf(r); // refuses now, before anything is simulated
        return watched(progress, context, [&](Watch& watch) {
            diagnosis::StoredFits fits;
            const diagnosis::Diagnosis d = diagnoseAll(r, e, watch, fits);
            if (d.stopped)
                return Json{{"status", "cancelled"}, {"message", ""}, {"notes", notes}};
            if (!d.failure.empty())
                return Json{{"status", "failed"}, {"message", d.failure}, {"notes", notes}};
            return Json{{"status", "done"},
                        {"message", ""},
                        {"notes", notes},
                        {"diagnosis", Json::parse(cli::diagnosisJson(d, fits))}};
        });
    });
}
