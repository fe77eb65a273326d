// supercircle-identify: recordings of real specimens.

#include "plugin/cli/command_line.h"
#include "plugin/cli/verbs.h"

#include <map>
#include <memory>

namespace supercircle::cli {

namespace {

void addEffects(CLI::App& verb, std::vector<std::string>& effects) {
    verb.add_option(
            "--effect", effects,
            "KEY:NAME=VALUE: extra physics, `supercircle effects` lists it (repeatable); KEY:shell=NAME for one shell")
        ->type_name("KEY:NAME=VALUE")
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

Subcommand describeImport(CLI::App& app) {
    auto arguments = std::make_shared<ImportArguments>(); // the options write into it
    ImportArguments& a = *arguments;
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
    return {verb, [arguments] { return cli::import(*arguments); }};
}

Subcommand describeReplay(CLI::App& app) {
    auto arguments = std::make_shared<ReplayArguments>(); // the options write into it
    ReplayArguments& a = *arguments;
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
    return {replay, [arguments] { return cli::replay(*arguments); }};
}

Subcommand describeSensitivity(CLI::App& app) {
    auto arguments = std::make_shared<SensitivityArguments>(); // the options write into it
    SensitivityArguments& a = *arguments;
    a.jobs = cores(64);
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
    addJobs(*verb, a.jobs, 64, "simulations at a time, 1 to 64; the digits do not depend on it");
    verb->add_flag("--quiet", a.quiet, "print nothing but errors");
    verb->footer("`supercircle check EXPERIMENT.json` lists the parameters. Exit codes: 0 done; 2 bad input; 3 a run\n"
                 "could not go on; 4 output could not be written; 130 interrupted.");
    return {verb, [arguments] { return cli::sensitivity(*arguments); }};
}

Subcommand describeCalibrate(CLI::App& app) {
    auto arguments = std::make_shared<CalibrateArguments>(); // the options write into it
    CalibrateArguments& a = *arguments;
    a.jobs = cores(64);
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
    addJobs(*verb, a.jobs, 64, "simulations at a time (curves), 1 to 64; the digits do not depend on it");
    verb->add_flag("--quiet", a.quiet, "print the result and errors only");
    verb->footer("Exit codes: 0 done; 2 bad input; 3 a run could not go on; 4 output could not be written;\n"
                 "130 interrupted.");
    return {verb, [arguments] { return cli::calibrate(*arguments); }};
}

Subcommand describeDiagnose(CLI::App& app) {
    auto arguments = std::make_shared<DiagnoseArguments>(); // the options write into it
    DiagnoseArguments& a = *arguments;
    a.jobs = cores(64);
    CLI::App* verb =
        app.add_subcommand("diagnose", "find out what physics a simulation of a recorded experiment leaves out");
    verb->add_option("experiment", a.file, "experiment file (JSON)")->required()->type_name("EXPERIMENT.json");
    verb->add_option("--out", a.out,
                     "folder for the results (default: out/<name of the experiment's folder>_diagnosis)")
        ->type_name("DIR");
    addJobs(*verb, a.jobs, 64, "simulations at a time, 1 to 64; the digits do not depend on it");
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
    return {verb, [arguments] { return cli::diagnose(*arguments); }};
}

} // namespace

} // namespace supercircle::cli

int main(int argc, char** argv) {
    using namespace supercircle::cli;
    const auto describe = [](CLI::App& app) {
        return std::vector<Subcommand>{describeImport(app), describeReplay(app), describeSensitivity(app),
                                       describeCalibrate(app), describeDiagnose(app)};
    };
    return runProgram(argc, argv, "supercircle", "Supercircle: recordings of real specimens", describe);
}
