// supercircle-lab: parameter studies, reference solutions, design.

#include "plugin/cli/command_line.h"
#include "plugin/cli/data_folders.h"
#include "plugin/cli/subcommands.h"

#include <memory>

namespace supercircle::cli {

namespace {

Subcommand describeSweep(CLI::App& app) {
    auto arguments = std::make_shared<SweepArguments>(); // the options write into it
    SweepArguments& a = *arguments;
    a.jobs = cores(1024);
    CLI::App* subcommand =
        app.add_subcommand("sweep", "simulate a scene for sets of parameter values and seeds; statistics");
    subcommand->add_option("sweep", a.file, "sweep file (JSON)")->required()->type_name("SWEEP.json");
    subcommand->add_option("--out", a.out, "folder for the results")->required()->type_name("DIR");
    subcommand->add_option("--seeds", a.seeds, "seeds in place of the file's, such as 1:20 or 1:5,8")
        ->type_name("LIST");
    addJobs(*subcommand, a.jobs, 1024, "runs at a time, 1 to 1024, each in its own process");
    addAccuracy(*subcommand, a.accuracy);
    subcommand->add_flag("--resume", a.resume, "continue a sweep into DIR that was stopped, or extend it");
    subcommand->add_option("--shard", a.shard, "I/N: only part I of N, into its own folder")->type_name("I/N");
    subcommand
        ->add_option("--engine", a.engine, "local: processes here; slurm: a job array, --jobs is its number of tasks")
        ->check(CLI::IsMember({"local", "slurm"}).description(""))
        ->type_name("local|slurm")
        ->capture_default_str();
    addRepeatable(*subcommand, "--slurm-option", a.slurmOptions,
                  "option for sbatch, such as --slurm-option=--time=60 (repeatable)")
        ->type_name("OPTION");
    subcommand->add_option("--merge", a.merge, "folders of shards, merged in DIR; nothing is simulated")
        ->type_name("DIR ...");
    subcommand->add_flag("--quiet", a.quiet, "print nothing but errors and failed runs");
    subcommand->footer("A stopped sweep continues with --resume and ends with the same bytes. Exit codes:\n"
                       "0 done; 2 bad input; 3 runs failed (failed.csv lists them); 4 output could not be written;\n"
                       "130 interrupted.");
    return {subcommand, [arguments] { return cli::sweep(*arguments); }};
}

Subcommand describeValidate(CLI::App& app) {
    auto arguments = std::make_shared<ValidateArguments>(); // the options write into it
    ValidateArguments& a = *arguments;
    a.data = referenceFolder();
    CLI::App* validate =
        app.add_subcommand("validate", "compare simulations with every solved reference; writes one page");
    validate->add_option("--data", a.data, "folder of the reference curves (default: the project's)")->type_name("DIR");
    validate->add_option("--out", a.out, "folder for the page and its pictures")
        ->type_name("DIR")
        ->capture_default_str();
    validate
        ->add_option("--filter", a.filter,
                     "an experiment, for example shell_on_cylinder, or all whose name or title contains this")
        ->type_name("NAME");
    validate->add_flag("--quick", a.quick, "a subset that takes seconds");
    addJobs(*validate, a.jobs, 64, "experiments at a time, 1 to 64; the results do not depend on it");
    return {validate, [arguments] { return cli::validate(*arguments); }};
}

Subcommand describeDesign(CLI::App& app) {
    auto arguments = std::make_shared<DesignArguments>(); // the options write into it
    DesignArguments& a = *arguments;
    CLI::App* subcommand = app.add_subcommand("design", "pairs of parameters that give a target value, from a sweep");
    subcommand->add_option("sweep", a.file, "sweep file (JSON)")->required()->type_name("SWEEP.json");
    subcommand->add_option("--results", a.results, "folder of the sweep's results")->required()->type_name("DIR");
    addRepeatable(*subcommand, "--target", a.targets,
                  "NAME=VALUE: a quantity of the summary, such as delta_max_over_R=4 (repeatable, at least one)")
        ->type_name("NAME=VALUE");
    addFormerName(*subcommand, "--want", "--target", a.targets);
    subcommand->add_option("--shells", a.shells, "size of the stack whose spread is computed (default: the sweep's)")
        ->check(positive)
        ->type_name("N");
    subcommand->add_option("--out", a.out, "folder for the chart and the table (default: design in the results)")
        ->type_name("DIR");
    subcommand->add_flag("--quiet", a.quiet, "print nothing but errors");
    subcommand->footer("Exit codes: 0 done; 2 bad input, or no pair gives the target; 4 output could not be written.");
    return {subcommand, [arguments] {
                endOnSignal();
                return cli::design(*arguments);
            }};
}

} // namespace

} // namespace supercircle::cli

int main(int argc, char** argv) {
    using namespace supercircle::cli;
    const auto describe = [](CLI::App& app) {
        return std::vector<Subcommand>{describeSweep(app), describeValidate(app), describeDesign(app),
                                       describeCheckOf(app, checkSweep)};
    };
    return runProgram(argc, argv, "supercircle", "Supercircle: the laboratory", describe);
}
