#include "plugin/cli/data.h"
#include "plugin/cli/verbs.h"

#include "plugin/scene/problem.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <exception>
#include <map>
#include <new>
#include <thread>

namespace supercircle::cli {
std::atomic<bool> interrupted{false};
}

namespace {

void onInterrupt(int signal) {
    supercircle::cli::interrupted = true;
    std::signal(signal, SIG_DFL); // a second Ctrl-C ends the program at once
}

void listenToSignals() {
    std::signal(SIGINT, onInterrupt);
    std::signal(SIGTERM, onInterrupt);
    std::signal(SIGHUP, onInterrupt);
    // A full disk, a file-size limit or a closed pipe is answered by the failing write, which can say what is wrong.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

const char* const kParameterHelp = "NAME=VALUE: set a parameter of the scene (repeatable)";

const char* const kExperimentParameterHelp = "NAME=VALUE: set a physical parameter of the experiment (repeatable)";

/// One NAME=VALUE after each --param: a greedy option would swallow the scene that follows it.
void addParameters(CLI::App& verb, std::vector<std::string>& parameters, const char* help = kParameterHelp) {
    verb.add_option("--param", parameters, help)
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void addEffects(CLI::App& verb, std::vector<std::string>& effects) {
    verb.add_option(
            "--effect", effects,
            "KEY:NAME=VALUE: extra physics, `supercircle effects` lists it (repeatable); KEY:shell=NAME for one shell")
        ->type_name("KEY:NAME=VALUE")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

std::string wholeFromZero(const std::string& text) {
    std::int64_t value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && value >= 0;
    return good ? "" : text + " is not a whole number from 0 to 9223372036854775807";
}

std::string positive(const std::string& text) {
    double value = 0.0;
    const bool good = CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0.0;
    return good ? "" : text + " is not a positive number";
}

void unknownVerb(const CLI::App& app, const std::string& word) {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
        verbs.push_back(verb->get_name());
    const std::string nearest = supercircle::scene::nearestName(word, verbs);
    std::fprintf(stderr, "there is no verb \"%s\"%s\nRun with --help for more information.\n", word.c_str(),
                 nearest.empty() ? "" : ("; did you mean \"" + nearest + "\"?").c_str());
}

CLI::App* describeRun(CLI::App& app, supercircle::cli::RunArguments& a) {
    CLI::App* run = app.add_subcommand("run", "simulate a scene and write summary, series, pictures and report");
    run->add_option("scene", a.scene, "scene file (JSON)")->required()->type_name("SCENE.json");
    addParameters(*run, a.parameters);
    run->add_option("--seed", a.seed, "seed of everything random, a whole number from 0")
        ->check(wholeFromZero)
        ->type_name("N")
        ->capture_default_str();
    run->add_option("--out", a.out, "folder for the results (default: out/<name of the scene file>)")->type_name("DIR");
    run->add_option("--threads", a.threads, "threads, 1 to 256; the digits do not depend on it")
        ->check(CLI::Range(1, 256).description(""))
        ->type_name("N")
        ->capture_default_str();
    run->add_option("--fixed-dt", a.fixedDt, "fixed time step instead of the adaptive one")
        ->check(positive)
        ->type_name("SECONDS");
    run->add_flag("--no-report", a.noReport, "no pictures and no page, only the data");
    run->add_flag("--quiet", a.quiet, "print nothing but errors");
    run->add_option("--dump", a.dump, "folder that receives every contact problem as an FCP2D file")->type_name("DIR");
    run->footer("Exit codes: 0 done; 2 bad input; 3 the simulation could not go on; 4 output could not be written;\n"
                "130 interrupted. After 3 and 130 what is done is written.");
    return run;
}

CLI::App* describeSweep(CLI::App& app, supercircle::cli::SweepArguments& a) {
    a.jobs = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 1024);
    CLI::App* verb = app.add_subcommand("sweep", "play a scene for sets of parameter values and seeds; statistics");
    verb->add_option("sweep", a.file, "sweep file (JSON)")->required()->type_name("SWEEP.json");
    verb->add_option("--out", a.out, "folder for the results")->required()->type_name("DIR");
    verb->add_option("--seeds", a.seeds, "seeds in place of the file's, such as 1:20 or 1:5,8")->type_name("LIST");
    verb->add_option("--jobs", a.jobs, "runs at a time, 1 to 1024, each a process of its own")
        ->check(CLI::Range(1, 1024).description(""))
        ->type_name("N")
        ->capture_default_str();
    verb->add_flag("--resume", a.resume, "go on where an earlier sweep into DIR was stopped, or extend it");
    verb->add_option("--shard", a.shard, "I/N: only part I of N, into a folder of its own")->type_name("I/N");
    verb->add_option("--engine", a.engine, "local: processes here; slurm: a job array, --jobs is its number of tasks")
        ->check(CLI::IsMember({"local", "slurm"}).description(""))
        ->type_name("local|slurm")
        ->capture_default_str();
    verb->add_option("--slurm-option", a.slurmOptions,
                     "option for sbatch, such as --slurm-option=--time=60 (repeatable)")
        ->type_name("OPTION")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    verb->add_option("--merge", a.merge, "folders of shards, taken together in DIR; nothing is played")
        ->type_name("DIR ...");
    verb->add_flag("--quiet", a.quiet, "print nothing but errors and failed runs");
    verb->footer("A sweep that was stopped, however, goes on with --resume and ends with the same bytes. Exit codes:\n"
                 "0 done; 2 bad input; 3 runs failed (failed.csv lists them); 4 output could not be written;\n"
                 "130 interrupted.");
    return verb;
}

CLI::App* describeCalibrate(CLI::App& app, supercircle::cli::CalibrateArguments& a) {
    a.jobs = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
    CLI::App* verb = app.add_subcommand(
        "calibrate", "friction coefficient from an observed switch between smooth and abrupt snaps, or from curves");
    verb->add_option("file", a.file,
                     "scene with phi_bar and mu whose summary has a snap_type (two_shells, shell_on_cylinder), or a "
                     "recorded experiment")
        ->required()
        ->type_name("FILE.json");
    verb->add_option("--smooth", a.smooth, "opening angles / 2 pi that snapped smoothly, such as 0.75,0.8")
        ->type_name("LIST");
    verb->add_option("--abrupt", a.abrupt, "opening angles / 2 pi that stuck and unfolded abruptly")->type_name("LIST");
    verb->add_option("--angle-uncertainty", a.angleUncertainty, "half-width of an opening angle / 2 pi")
        ->check(positive)
        ->type_name("VALUE");
    verb->add_option("--tolerance", a.tolerance, "of the coefficient at which an angle switches")
        ->check(positive)
        ->type_name("VALUE")
        ->capture_default_str();
    addParameters(*verb, a.parameters);
    verb->add_option("--out", a.out, "folder for calibration.json (default: nothing is written)")->type_name("DIR");
    verb->add_option("--jobs", a.jobs, "simulations at a time (curves), 1 to 64; the digits do not depend on it")
        ->check(CLI::Range(1, 64).description(""))
        ->type_name("N")
        ->capture_default_str();
    verb->add_flag("--quiet", a.quiet, "print the result and errors only");
    verb->footer("Exit codes: 0 done; 2 bad input; 3 a run could not go on; 4 output could not be written;\n"
                 "130 interrupted.");
    return verb;
}

CLI::App* describeDesign(CLI::App& app, supercircle::cli::DesignArguments& a) {
    CLI::App* verb = app.add_subcommand("design", "pairs of parameters that give a wanted number, from a sweep");
    verb->add_option("sweep", a.file, "sweep file (JSON)")->required()->type_name("SWEEP.json");
    verb->add_option("--results", a.results, "folder the sweep was played into")->required()->type_name("DIR");
    verb->add_option("--want", a.want, "NAME=VALUE: a number of the summary, such as delta_max_over_R=4 (repeatable)")
        ->required()
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    verb->add_option("--shells", a.shells, "size of the stack whose spread is wanted (default: the sweep's)")
        ->check(positive)
        ->type_name("N");
    verb->add_option("--out", a.out, "folder for the chart and the table (default: design in the results)")
        ->type_name("DIR");
    verb->add_flag("--quiet", a.quiet, "print nothing but errors");
    verb->footer("Exit codes: 0 done; 2 bad input, or no pair gives what is wanted; 4 output could not be written.");
    return verb;
}

CLI::App* describeReplay(CLI::App& app, supercircle::cli::ReplayArguments& a) {
    CLI::App* replay = app.add_subcommand("replay", "simulate a recorded experiment and show what differs");
    replay->add_option("experiment", a.file, "experiment file (JSON)")->required()->type_name("EXPERIMENT.json");
    addParameters(*replay, a.parameters, kExperimentParameterHelp);
    addEffects(*replay, a.effects);
    replay->add_option("--out", a.out, "folder for the results (default: out/<name of the experiment's folder>_replay)")
        ->type_name("DIR");
    replay->add_option("--elements", a.elements, "arcs per specimen, 2 to 500 (default: as the resolution has it)")
        ->check(CLI::Range(2, 500).description(""))
        ->type_name("N");
    replay->add_flag("--coarse", a.coarse, "the quick resolution instead of the full one");
    replay->add_flag("--quiet", a.quiet, "print nothing but errors");
    replay->footer(
        "`supercircle check EXPERIMENT.json` lists the parameters. Exit codes: 0 done; 2 bad input; 3 a run\n"
        "could not go on; 4 output could not be written; 130 interrupted.");
    return replay;
}

CLI::App* describeImport(CLI::App& app, supercircle::cli::ImportArguments& a) {
    CLI::App* verb =
        app.add_subcommand("import", "testing-machine exports to an experiment, saying what was understood");
    verb->add_option("files", a.files,
                     "exports (CSV or text), one or more runs each; a file of markers follows its run")
        ->required()
        ->type_name("FILE.csv ...");
    verb->add_option("--out", a.out, "folder for experiment.json and the runs")->required()->type_name("DIR");
    verb->add_option("--protocol", a.protocol,
                     "shell_on_rigid_cylinder, two_shells, strip_on_rigid_floor, arch_between_plates,\n"
                     "ring_between_plates, tethered_strip or free_scene")
        ->type_name("NAME");
    verb->add_option("--specimen", a.specimen, "JSON with the specimen, or with any part of an experiment")
        ->type_name("FILE.json");
    verb->add_option("--columns", a.columns,
                     "what the columns are: time[s],displacement[mm],force[kN],angle[deg],NAME_x[mm]; - for none")
        ->type_name("LIST");
    verb->add_option("--rate", a.rate, "rows per second, where there are no times")->check(positive)->type_name("HZ");
    verb->add_option("--speed", a.speed, "speed of the head in mm/s, where there are no times")
        ->check(positive)
        ->type_name("MM_PER_S");
    verb->add_option("--tolerance", a.tolerance, "mm, how closely straight legs follow the displacement")
        ->check(positive)
        ->type_name("MM");
    verb->add_option("--scene", a.scene, "angles: scene of the mechanism that moves by itself")
        ->type_name("SCENE.json");
    verb->add_option("--from-turn", a.fromTurn,
                     "angles: from turning point N on; 1: the hand lifts no more, 2: it is gone")
        ->check(positive)
        ->type_name("N");
    verb->add_option("--average", a.average, "angles: rows are means of so many")->check(positive)->type_name("N");
    const std::map<std::string, int> signs{{"positive", 1}, {"negative", -1}};
    verb->add_option("--displacement", a.displacementSign, "sign of the column as the head nears the specimen")
        ->transform(CLI::Transformer(signs).description(""))
        ->check(CLI::IsMember({1, -1}).description(""))
        ->type_name("positive|negative");
    verb->add_option("--force", a.forceSign, "sign of the column while the specimen resists")
        ->transform(CLI::Transformer(signs).description(""))
        ->check(CLI::IsMember({1, -1}).description(""))
        ->type_name("positive|negative");
    verb->add_flag("--quiet", a.quiet, "print nothing but errors");
    verb->footer("Exit codes: 0 done; 2 bad input; 4 output could not be written.");
    return verb;
}

CLI::App* describeSensitivity(CLI::App& app, supercircle::cli::SensitivityArguments& a) {
    a.jobs = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
    CLI::App* verb = app.add_subcommand("sensitivity", "how a recorded experiment's readings depend on its parameters");
    verb->add_option("experiment", a.file, "experiment file (JSON)")->required()->type_name("EXPERIMENT.json");
    addParameters(*verb, a.parameters, kExperimentParameterHelp);
    verb->add_option("--column", a.columns, "NAME: vary only this parameter (repeatable; default: all)")
        ->type_name("NAME")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    verb->add_flag("--effects", a.effects, "vary the amplitudes of all extra physics too (supercircle effects)");
    verb->add_option("--out", a.out,
                     "folder for the results (default: out/<name of the experiment's folder>_sensitivity)")
        ->type_name("DIR");
    verb->add_option("--elements", a.elements, "arcs per specimen, 2 to 500 (default: as the resolution has it)")
        ->check(CLI::Range(2, 500).description(""))
        ->type_name("N");
    verb->add_flag("--full", a.full, "the resolution for residuals instead of the coarse one");
    verb->add_option("--jobs", a.jobs, "simulations at a time, 1 to 64; the digits do not depend on it")
        ->check(CLI::Range(1, 64).description(""))
        ->type_name("N")
        ->capture_default_str();
    verb->add_flag("--quiet", a.quiet, "print nothing but errors");
    verb->footer("`supercircle check EXPERIMENT.json` lists the parameters. Exit codes: 0 done; 2 bad input; 3 a run\n"
                 "could not go on; 4 output could not be written; 130 interrupted.");
    return verb;
}

CLI::App* describeDiagnose(CLI::App& app, supercircle::cli::DiagnoseArguments& a) {
    a.jobs = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64);
    CLI::App* verb =
        app.add_subcommand("diagnose", "find out what physics a simulation of a recorded experiment leaves out");
    verb->add_option("experiment", a.file, "experiment file (JSON)")->required()->type_name("EXPERIMENT.json");
    verb->add_option("--out", a.out,
                     "folder for the results (default: out/<name of the experiment's folder>_diagnosis)")
        ->type_name("DIR");
    verb->add_option("--jobs", a.jobs, "simulations at a time, 1 to 64; the digits do not depend on it")
        ->check(CLI::Range(1, 64).description(""))
        ->type_name("N")
        ->capture_default_str();
    verb->add_option("--seed", a.seed, "seed of the null distributions, a whole number from 0")
        ->check(wholeFromZero)
        ->type_name("N")
        ->capture_default_str();
    verb->add_option("--without", a.without, "EFFECT[,EFFECT]: leave them out of the catalogue (repeatable)")
        ->delimiter(',')
        ->type_name("EFFECT")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    verb->add_flag(
        "--no-next", a.noNext,
        "do not look for the next run to make, where one is wanted (a hundred simulations and more); without this\n"
        "flag the same command looks for it, from the simulations that are kept");
    verb->add_option("--ablate", a.ablate,
                     "PART of the method to leave out, to see what it is good for: whitening, heldout, probes, unknown")
        ->check(CLI::IsMember({"whitening", "heldout", "probes", "unknown"}))
        ->type_name("PART")
        ->allow_extra_args(false)
        ->group("Advanced (docs/proof.md)")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    verb->add_flag("--quiet", a.quiet, "print nothing but errors");
    verb->footer("Simulations are kept in DIR: a diagnosis that was stopped goes on from there. Exit codes: 0 done; 2\n"
                 "bad input; 3 a run could not go on; 4 output could not be written; 130 interrupted.");
    return verb;
}

CLI::App* describeValidate(CLI::App& app, supercircle::cli::ValidateArguments& a) {
    a.data = supercircle::cli::referenceFolder();
    CLI::App* validate =
        app.add_subcommand("validate", "compare the laboratory with every solved reference; writes one page");
    validate->add_option("--data", a.data, "folder of the reference curves (default: the project's)")->type_name("DIR");
    validate->add_option("--out", a.out, "folder for the page and its pictures")
        ->type_name("DIR")
        ->capture_default_str();
    validate->add_option("--filter", a.filter, "only experiments whose name contains this, for example T2")
        ->type_name("NAME");
    validate->add_flag("--quick", a.quick, "a subset that takes seconds");
    validate->add_option("--jobs", a.jobs, "experiments at a time, 1 to 64; the digits do not depend on it")
        ->check(CLI::Range(1, 64).description(""))
        ->type_name("N")
        ->capture_default_str();
    return validate;
}

CLI::App* describeView(CLI::App& app, supercircle::cli::ViewArguments& a) {
    CLI::App* view = app.add_subcommand("view", "watch a scene in a window: sliders, layers, live curves");
    view->add_option("scene", a.scene, "scene file (JSON)")->required()->type_name("SCENE.json");
    addParameters(*view, a.parameters);
    view->add_flag("--game", a.game, "game quality instead of the laboratory's");
    view->add_flag("--headless", a.headless, "no window: play, write the picture, end");
    view->add_option("--frames", a.frames, "steps of 1/60 s, headless")
        ->check(CLI::Range(1, 1000000).description(""))
        ->type_name("N")
        ->capture_default_str();
    view->add_option("--png", a.png, "the last picture, headless")->type_name("FILE");
    view->add_option("--script", a.script, "timed inputs (docs/levels.md)")->type_name("FILE.json");
    view->add_option("--show", a.show, "layers: curvature, energy, contacts, slip, proxies, boxes; with commas")
        ->type_name("NAMES");
    view->add_option("--record", a.record, "film of the pictures; the motion goes beside it as .csv")
        ->type_name("FILE.mp4");
    return view;
}

/// Parses, and runs what was asked for.
int dispatch(int argc, char** argv) {
    using namespace supercircle::cli;
    CLI::App app{"Supercircle: flexible open shells in 2D physics", "supercircle"};
    app.set_version_flag("--version", SC_VERSION);
    app.require_subcommand(1);
    app.failure_message(CLI::FailureMessage::simple);

    RunArguments runArguments;
    CLI::App* run = describeRun(app, runArguments);

    SweepArguments sweepArguments;
    CLI::App* sweep = describeSweep(app, sweepArguments);

    CalibrateArguments calibrateArguments;
    CLI::App* calibrate = describeCalibrate(app, calibrateArguments);

    DesignArguments designArguments;
    CLI::App* design = describeDesign(app, designArguments);

    ReplayArguments replayArguments;
    CLI::App* replay = describeReplay(app, replayArguments);

    ImportArguments importArguments;
    CLI::App* import = describeImport(app, importArguments);

    SensitivityArguments sensitivityArguments;
    CLI::App* sensitivity = describeSensitivity(app, sensitivityArguments);

    DiagnoseArguments diagnoseArguments;
    CLI::App* diagnose = describeDiagnose(app, diagnoseArguments);

    std::string file;
    std::vector<std::string> parameters;
    CLI::App* check = app.add_subcommand(
        "check", "validate a scene, sweep or experiment without running it, and list its parameters");
    check->add_option("file", file, "scene, sweep or experiment file (JSON)")->required()->type_name("FILE.json");
    addParameters(*check, parameters);

    ValidateArguments validateArguments;
    CLI::App* validate = describeValidate(app, validateArguments);

    ViewArguments viewArguments;
    CLI::App* view = describeView(app, viewArguments);

    std::string effectName;
    CLI::App* effects = app.add_subcommand("effects", "list the extra physics a scene or a replay may switch on");
    effects->add_option("key", effectName, "only this one, with all it has to say")->type_name("KEY");

    std::string filter, json;
    CLI::App* bench = app.add_subcommand("bench", "measure speed and memory");
    bench->add_option("--filter", filter, "only benchmarks whose name contains this")->type_name("NAME");
    bench->add_option("--json", json, "write the figures to this file")->type_name("FILE");

    try {
        app.parse(argc, argv);
    } catch (const CLI::RequiredError& e) {
        if (argc > 1 && app.get_subcommands().empty()) { // CLI11 would say that one is required, not that it is unknown
            unknownVerb(app, argv[1]);
            return kBadInput;
        }
        app.exit(e);
        return kBadInput;
    } catch (const CLI::ParseError& e) {
        return app.exit(e) == 0 ? kDone : kBadInput; // help and version come here too, with 0
    }
    if (run->parsed())
        return supercircle::cli::run(runArguments);
    if (sweep->parsed())
        return supercircle::cli::sweep(sweepArguments);
    if (calibrate->parsed())
        return supercircle::cli::calibrate(calibrateArguments);
    if (design->parsed())
        return supercircle::cli::design(designArguments);
    if (replay->parsed())
        return supercircle::cli::replay(replayArguments);
    if (import->parsed())
        return supercircle::cli::import(importArguments);
    if (effects->parsed())
        return supercircle::cli::effects(effectName);
    if (diagnose->parsed())
        return supercircle::cli::diagnose(diagnoseArguments);
    if (sensitivity->parsed())
        return supercircle::cli::sensitivity(sensitivityArguments);
    if (check->parsed())
        return supercircle::cli::check(file, parameters);
    if (validate->parsed())
        return supercircle::cli::validate(validateArguments);
    if (view->parsed())
        return supercircle::cli::view(viewArguments);
    if (bench->parsed())
        return supercircle::cli::bench(filter, json);
    return kBadInput;
}

} // namespace

int main(int argc, char** argv) {
    listenToSignals();
    try {
        return dispatch(argc, argv);
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "supercircle: out of memory\n");
    } catch (const std::exception& e) {
        std::fprintf(stderr, "supercircle: stopped by an error of its own, please report it: %s\n", e.what());
    }
    return supercircle::cli::kCannotGoOn;
}
