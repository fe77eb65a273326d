// supercircle-identify: subcommands on recordings of specimens.

#include "plugin/cli/command_line.h"
#include "plugin/cli/subcommands.h"

#include <cstdio>
#include <functional>
#include <map>
#include <memory>

namespace supercircle::cli {

namespace {

/// Reports the use of an option of version 0.1.
void warnRenamed(const std::string& old, const std::string& successor) {
    std::fprintf(stderr, "%s is deprecated and will be removed in version 0.3; use %s\n", old.c_str(),
                 successor.c_str());
}

/// --fidelity coarse|fine; `coarse` is set accordingly.
void addFidelity(CLI::App& app, const std::string& help, const std::function<void(bool coarse)>& set) {
    app.add_option_function<std::string>(
           "--fidelity", [set](const std::string& value) { set(value == "coarse"); }, help)
        ->check(CLI::IsMember({"coarse", "fine"}).description(""))
        ->type_name("coarse|fine");
}

/// A part of the method for --ablate; names of version 0.1 are translated.
std::string ablatedPart(std::string name) {
    static const std::map<std::string, std::string> renamed{
        {"probes", "screening"}, {"heldout", "cross_validation"}, {"unknown", "open_set"}};
    const auto at = renamed.find(name);
    if (at == renamed.end())
        return name;
    warnRenamed("--ablate " + name, "--ablate " + at->second);
    return at->second;
}

void addEffects(CLI::App& subcommand, std::vector<std::string>& effects) {
    addRepeatable(
        subcommand, "--effect", effects,
        "KEY:NAME=VALUE: extra physics, `supercircle effects` lists it (repeatable); KEY:shell=NAME for one shell;\n"
        "NAME:FORMULA and NAME:PARAMETER=VALUE: a law of your own, such as mine:\"mu*(1+a*log(1+v/v0))\"")
        ->type_name("KEY:NAME=VALUE|NAME:FORMULA");
}

Subcommand describeImport(CLI::App& app) {
    auto arguments = std::make_shared<ImportArguments>(); // the options refer to it
    ImportArguments& a = *arguments;
    CLI::App* subcommand =
        app.add_subcommand("import", "convert testing-machine exports to an experiment and report how they were read");
    subcommand
        ->add_option("files", a.files,
                     "exports (CSV or text) with one or more runs each; a file of markers follows its run")
        ->required()
        ->type_name("FILE.csv ...");
    subcommand->add_option("--out", a.out, "folder for experiment.json and the runs")->required()->type_name("DIR");
    subcommand
        ->add_option("--protocol", a.protocol,
                     "shell_on_rigid_cylinder, two_shells, strip_on_rigid_floor, arch_between_plates,\n"
                     "ring_between_plates, tethered_strip, free_scene or scene")
        ->type_name("NAME");
    subcommand->add_option("--specimen", a.specimen, "JSON with the specimen, or with any part of an experiment")
        ->type_name("FILE.json");
    subcommand
        ->add_option(
            "--columns", a.columns,
            "quantities of the columns: time[s],displacement[mm],force[kN],angle[deg],NAME_x[mm]; - to skip one")
        ->type_name("LIST");
    subcommand->add_option("--units", a.units, "units of columns that state none, for instance s,mm,N")
        ->type_name("LIST");
    subcommand->add_option("--rate", a.rate, "sampling rate, for files without times")
        ->check(positive)
        ->type_name("HZ");
    subcommand->add_option("--speed", a.speed, "speed of the crosshead in mm/s, for files without times")
        ->check(positive)
        ->type_name("MM_PER_S");
    subcommand->add_option("--tolerance", a.tolerance, "mm, tolerance of the piecewise linear drive")
        ->check(positive)
        ->type_name("MM");
    subcommand
        ->add_option("--scene", a.scene,
                     "scene of the set-up, or the name of a shipped one: a mechanism that moves freely, or one with a "
                     "machine or a load")
        ->type_name("SCENE.json");
    subcommand
        ->add_option("--from-turning-point", a.fromTurningPoint,
                     "for angles: start at turning point N; 1: after the lift, 2: surely after the release")
        ->check(positive)
        ->type_name("N");
    subcommand
        ->add_option_function<int>(
            "--from-turn",
            [&a](const int& n) {
                warnRenamed("--from-turn", "--from-turning-point");
                a.fromTurningPoint = n;
            },
            "old name of --from-turning-point")
        ->check(positive)
        ->type_name("N")
        ->group("");
    subcommand->add_option("--average", a.average, "for angles: average N rows into one")
        ->check(positive)
        ->type_name("N");
    subcommand->add_option("--encoding", a.encoding, "encoding of a text that is neither UTF-8 nor UTF-16")
        ->check(CLI::IsMember({"windows-1252", "windows-1251", "shift-jis"}).description(""))
        ->type_name("windows-1252|windows-1251|shift-jis");
    const std::map<std::string, int> signs{{"positive", 1}, {"negative", -1}};
    subcommand
        ->add_option("--displacement", a.displacementSign,
                     "sign of the column while the crosshead approaches the specimen")
        ->transform(CLI::Transformer(signs).description(""))
        ->check(CLI::IsMember({1, -1}).description(""))
        ->type_name("positive|negative");
    subcommand->add_option("--force", a.forceSign, "sign of the column while the specimen resists")
        ->transform(CLI::Transformer(signs).description(""))
        ->check(CLI::IsMember({1, -1}).description(""))
        ->type_name("positive|negative");
    subcommand
        ->add_option("--force-zero", a.forceZero,
                     "zero of the force: none, a range of times in s (T0..T1), or a value in N")
        ->type_name("none|T0..T1|VALUE");
    addRepeatable(
        *subcommand, "--accept", a.accept,
        "import although: rows are dropped, values jump and come back, a spreadsheet has moved decimal marks (they "
        "stay where they are), the unit of the force is doubtful")
        ->check(CLI::IsMember({"dropped", "jumps", "marks", "units"}).description(""))
        ->type_name("dropped|jumps|marks|units");
    addRepeatable(
        *subcommand, "--cut", a.cut,
        "leave out the rows after a break, the first sudden fall of the force, or the first gap in the samples")
        ->check(CLI::IsMember({"break", "falls", "gaps"}).description(""))
        ->type_name("break|falls|gaps");
    addRepeatable(*subcommand, "--keep", a.keep, "keep the force where the sensor is saturated")
        ->check(CLI::IsMember({"saturation"}).description(""))
        ->type_name("saturation");
    subcommand->add_flag("--quiet", a.quiet, "print nothing but errors");
    subcommand->footer("Exit codes: 0 done; 2 bad input; 4 output could not be written.");
    return {subcommand, [arguments] {
                endOnSignal();
                return cli::import(*arguments);
            }};
}

Subcommand describeReplay(CLI::App& app) {
    auto arguments = std::make_shared<ReplayArguments>(); // the options refer to it
    ReplayArguments& a = *arguments;
    CLI::App* replay =
        app.add_subcommand("replay", "simulate a recorded experiment and compare it with the recordings");
    replay->add_option("experiment", a.file, "experiment file (JSON)")->required()->type_name("EXPERIMENT.json");
    addAllowOutside(*replay);
    addParameters(*replay, a.parameters, kExperimentParameterHelp);
    addEffects(*replay, a.effects);
    CLI::Option* with = replay->add_option("--with", a.with,
                                           "repeat a fit of a diagnosis of this experiment: the drawn one, that of an "
                                           "effect, or :nothing");
    with->type_name("diagnosis.json[:LABEL]");
    replay
        ->add_option("--carry", a.carry,
                     "take the law that a diagnosis of another specimen found, restated for this section")
        ->type_name("diagnosis.json[:LABEL]")
        ->excludes(with);
    replay->add_option("--out", a.out, "folder for the results (default: out/<name of the experiment's folder>_replay)")
        ->type_name("DIR");
    replay->add_option("--elements", a.elements, "arcs per specimen, 2 to 500 (default: set by the fidelity)")
        ->check(CLI::Range(2, 500).description(""))
        ->type_name("N");
    addFidelity(*replay, "resolution of the simulation (default: fine)", [&a](bool coarse) { a.coarse = coarse; });
    replay
        ->add_flag_function(
            "--coarse",
            [&a](std::int64_t) {
                warnRenamed("--coarse", "--fidelity coarse");
                a.coarse = true;
            },
            "old name of --fidelity coarse")
        ->group("");
    replay->add_flag("--quiet", a.quiet, "print nothing but errors");
    replay->footer(
        "`supercircle check EXPERIMENT.json` lists the parameters. Exit codes: 0 done; 2 bad input; 3 a run\n"
        "could not go on; 4 output could not be written; 130 interrupted.");
    return {replay, [arguments] { return cli::replay(*arguments); }};
}

Subcommand describeSensitivity(CLI::App& app) {
    auto arguments = std::make_shared<SensitivityArguments>(); // the options refer to it
    SensitivityArguments& a = *arguments;
    a.jobs = cores(64);
    CLI::App* subcommand = app.add_subcommand(
        "sensitivity", "derivatives of a recorded experiment's readings with respect to its parameters");
    subcommand->add_option("experiment", a.file, "experiment file (JSON)")->required()->type_name("EXPERIMENT.json");
    addAllowOutside(*subcommand);
    addParameters(*subcommand, a.parameters, kExperimentParameterHelp);
    addRepeatable(*subcommand, "--column", a.columns, "NAME: vary only this parameter (repeatable; default: all)")
        ->type_name("NAME");
    subcommand->add_option("--channel", a.channel, "channel of a scene, by what it observes (default: the first one)")
        ->type_name("NAME");
    subcommand->add_flag("--effects", a.effects, "vary the amplitudes of all effects too (supercircle effects)");
    subcommand
        ->add_option("--out", a.out,
                     "folder for the results (default: out/<name of the experiment's folder>_sensitivity)")
        ->type_name("DIR");
    subcommand->add_option("--elements", a.elements, "arcs per specimen, 2 to 500 (default: set by the fidelity)")
        ->check(CLI::Range(2, 500).description(""))
        ->type_name("N");
    addFidelity(*subcommand, "resolution of the simulations (default: coarse)",
                [&a](bool coarse) { a.full = !coarse; });
    subcommand
        ->add_flag_function(
            "--full",
            [&a](std::int64_t) {
                warnRenamed("--full", "--fidelity fine");
                a.full = true;
            },
            "old name of --fidelity fine")
        ->group("");
    addJobs(*subcommand, a.jobs, 64, "simulations at a time, 1 to 64; results do not depend on it");
    subcommand->add_flag("--quiet", a.quiet, "print nothing but errors");
    subcommand->footer(
        "`supercircle check EXPERIMENT.json` lists the parameters. Exit codes: 0 done; 2 bad input; 3 a run\n"
        "could not go on; 4 output could not be written; 130 interrupted.");
    return {subcommand, [arguments] { return cli::sensitivity(*arguments); }};
}

Subcommand describeCalibrate(CLI::App& app) {
    auto arguments = std::make_shared<CalibrateArguments>(); // the options refer to it
    CalibrateArguments& a = *arguments;
    a.jobs = cores(64);
    CLI::App* subcommand = app.add_subcommand(
        "calibrate",
        "friction coefficient from an observed switch between smooth and abrupt snaps, or from force curves");
    subcommand
        ->add_option("file", a.file,
                     "scene with phi_bar and mu whose summary has a snap_type (two_shells, shell_on_cylinder), or a "
                     "recorded experiment")
        ->required()
        ->type_name("FILE.json");
    addAllowOutside(*subcommand);
    subcommand->add_option("--smooth", a.smooth, "opening angles / 2 pi that snapped smoothly, such as 0.75,0.8")
        ->type_name("LIST");
    subcommand->add_option("--abrupt", a.abrupt, "opening angles / 2 pi that stuck and unfolded abruptly")
        ->type_name("LIST");
    subcommand->add_option("--angle-uncertainty", a.angleUncertainty, "half-width of an opening angle / 2 pi")
        ->check(positive)
        ->type_name("VALUE");
    subcommand->add_option("--tolerance", a.tolerance, "accuracy of the critical coefficient of an angle")
        ->check(positive)
        ->type_name("VALUE")
        ->capture_default_str();
    subcommand->add_option("--channel", a.channel, "channel of a scene, by what it observes (default: the first one)")
        ->type_name("NAME");
    addParameters(*subcommand, a.parameters);
    subcommand->add_option("--out", a.out, "folder for calibration.json (default: nothing is written)")
        ->type_name("DIR");
    addJobs(*subcommand, a.jobs, 64, "simulations at a time (curves), 1 to 64; results do not depend on it");
    subcommand->add_flag("--quiet", a.quiet, "print the result and errors only");
    subcommand->footer("Exit codes: 0 done; 2 bad input; 3 a run could not go on; 4 output could not be written;\n"
                       "130 interrupted.");
    return {subcommand, [arguments] { return cli::calibrate(*arguments); }};
}

Subcommand describeDiagnose(CLI::App& app) {
    auto arguments = std::make_shared<DiagnoseArguments>(); // the options refer to it
    DiagnoseArguments& a = *arguments;
    a.jobs = cores(64);
    CLI::App* subcommand =
        app.add_subcommand("diagnose", "identify the physics that the simulation of a recorded experiment leaves out");
    subcommand->add_option("experiment", a.file, "experiment file (JSON)")->required()->type_name("EXPERIMENT.json");
    addAllowOutside(*subcommand);
    subcommand
        ->add_option("--out", a.out,
                     "folder for the results (default: out/<name of the experiment's folder>_diagnosis)")
        ->type_name("DIR");
    addJobs(*subcommand, a.jobs, 64, "simulations at a time, 1 to 64; results do not depend on it");
    subcommand->add_option("--seed", a.seed, "seed of the null distributions, a whole number from 0")
        ->check(wholeFromZero)
        ->type_name("N")
        ->capture_default_str();
    addRepeatable(*subcommand, "--effect", a.effects,
                  "NAME:FORMULA and NAME:PARAMETER=START: a law of your own competes with the catalogue, such as "
                  "mine:\"mu*(1+a*log(1+v/v0))\" mine:a=0.1 mine:v0=0.001 (repeatable)")
        ->type_name("NAME:FORMULA|NAME:PARAMETER=START");
    addRepeatable(*subcommand, "--without", a.without, "EFFECT[,EFFECT]: remove these from the catalogue (repeatable)")
        ->delimiter(',')
        ->type_name("EFFECT");
    subcommand
        ->add_option("--time-limit", a.timeLimit,
                     "minutes after which nothing further is tried; the best verdict so far is written and says what\n"
                     "was not tried. 0: no limit")
        ->check(CLI::Range(0.0, 1e6).description(""))
        ->type_name("MINUTES")
        ->capture_default_str();
    subcommand
        ->add_option("--cpu-limit", a.cpuLimit,
                     "the same in minutes of processor time, which other programs do not shorten. 0: no limit")
        ->check(CLI::Range(0.0, 1e6).description(""))
        ->type_name("MINUTES")
        ->capture_default_str();
    subcommand->add_flag(
        "--skip-next-experiment", a.skipNextExperiment,
        "do not choose a next experiment (it takes a hundred simulations or more); a later command without this\n"
        "flag chooses it, using the cached simulations");
    subcommand
        ->add_flag_function(
            "--no-next",
            [&a](std::int64_t) {
                warnRenamed("--no-next", "--skip-next-experiment");
                a.skipNextExperiment = true;
            },
            "old name of --skip-next-experiment")
        ->group("");
    addRepeatable(*subcommand, "--ablate", a.ablate,
                  "PART of the method to switch off: whitening, cross_validation, screening, open_set")
        ->check(CLI::IsMember({"whitening", "cross_validation", "screening", "open_set"}).description(""))
        ->transform(ablatedPart)
        ->type_name("PART")
        ->group("Advanced (docs/results/diagnosis.md)");
    subcommand->add_flag("--quiet", a.quiet, "print nothing but errors");
    subcommand->footer("Simulations are cached in DIR, so an interrupted diagnosis continues. Exit codes: 0 done; 2\n"
                       "bad input; 3 a run could not go on; 4 output could not be written; 130 interrupted.");
    return {subcommand, [arguments] { return cli::diagnose(*arguments); }};
}

} // namespace

} // namespace supercircle::cli

int main(int argc, char** argv) {
    using namespace supercircle::cli;
    const auto describe = [](CLI::App& app) {
        return std::vector<Subcommand>{describeImport(app),      describeReplay(app),
                                       describeSensitivity(app), describeCalibrate(app),
                                       describeDiagnose(app),    describeCheckOf(app, checkExperiment)};
    };
    return runProgram(argc, argv, "supercircle", "Supercircle: recordings of real specimens", describe);
}
