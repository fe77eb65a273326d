// supercircle: runs and checks scenes, and starts the programs beside it for everything else.

#include "plugin/cli/command_line.h"
#include "plugin/cli/subcommands.h"

#include <memory>

namespace supercircle::cli {

namespace {

Subcommand describeRun(CLI::App& app) {
    auto arguments = std::make_shared<RunArguments>(); // the options write into it
    RunArguments& a = *arguments;
    CLI::App* run = app.add_subcommand("run", "simulate a scene and write summary, series, pictures and report");
    run->add_option("scene", a.scene, "scene file (JSON)")->required()->type_name("SCENE.json");
    addParameters(*run, a.parameters);
    run->add_option("--seed", a.seed, "seed of everything random, a whole number from 0")
        ->check(wholeFromZero)
        ->type_name("N")
        ->capture_default_str();
    run->add_option("--out", a.out, "folder for the results (default: out/<name of the scene file>)")->type_name("DIR");
    run->add_option("--threads", a.threads, "threads, 1 to 256; the results do not depend on it")
        ->check(CLI::Range(1, 256).description(""))
        ->type_name("N")
        ->capture_default_str();
    run->add_option("--fixed-dt", a.fixedDt, "fixed time step instead of the adaptive one")
        ->check(positive)
        ->type_name("SECONDS");
    addAccuracy(*run, a.accuracy);
    run->add_flag("--no-report", a.noReport, "no pictures and no page, only the data");
    run->add_flag("--quiet", a.quiet, "print nothing but errors");
    run->add_option("--dump", a.dump, "folder that receives every contact problem as an FCP2D file")->type_name("DIR");
    run->add_option("--checkpoint", a.checkpoint,
                    "keep a state in the output folder, so often and when interrupted, from which --resume continues")
        ->check(positive)
        ->type_name("SECONDS");
    run->add_flag("--resume", a.resume, "continue from the state in the output folder, to the same bytes");
    run->footer("Exit codes: 0 done; 2 bad input; 3 the simulation could not go on; 4 output could not be written;\n"
                "130 interrupted. After 3 and 130 the results so far are written.");
    return {run, [arguments] { return cli::run(*arguments); }};
}

Subcommand describeCheck(CLI::App& app) {
    struct Arguments {
        std::string file;
        std::vector<std::string> parameters;
    };
    auto a = std::make_shared<Arguments>(); // the options write into it
    CLI::App* subcommand = app.add_subcommand(
        "check", "validate a scene, sweep or experiment without running it, and list its parameters");
    subcommand->add_option("file", a->file, "scene, sweep or experiment file (JSON)")
        ->required()
        ->type_name("FILE.json");
    addParameters(*subcommand, a->parameters);
    addAllowOutside(*subcommand);
    return {subcommand, [a] {
                endOnSignal();
                return check(a->file, a->parameters);
            }};
}

Subcommand describeEffects(CLI::App& app) {
    auto key = std::make_shared<std::string>();
    CLI::App* subcommand = app.add_subcommand("effects", "list the effects that a scene or a replay may switch on");
    subcommand->add_option("key", *key, "only this one, in full")->type_name("KEY");
    return {subcommand, [key] {
                endOnSignal();
                return effects(*key);
            }};
}

const std::vector<Sibling> kSiblings = {
    {"sweep", "supercircle-lab", "simulate a scene for sets of parameter values and seeds; statistics"},
    {"validate", "supercircle-lab", "compare simulations with every solved reference; writes one page"},
    {"design", "supercircle-lab", "pairs of parameters that give a target value, from a sweep"},
    {"import", "supercircle-identify", "testing-machine exports to an experiment, saying what was understood"},
    {"replay", "supercircle-identify", "simulate a recorded experiment and show what differs"},
    {"sensitivity", "supercircle-identify", "how a recorded experiment's readings depend on its parameters"},
    {"calibrate", "supercircle-identify",
     "friction coefficient from an observed switch between smooth and abrupt snaps, or from curves"},
    {"diagnose", "supercircle-identify", "find out what physics a simulation of a recorded experiment leaves out"},
    {"view", "supercircle-view", "watch a scene in a window: sliders, layers, live curves", false},
    {"bench", "supercircle-bench", "measure speed and memory", false},
};

} // namespace

} // namespace supercircle::cli

int main(int argc, char** argv) {
    using namespace supercircle::cli;
    const auto describe = [](CLI::App& app) {
        return std::vector<Subcommand>{describeRun(app), describeCheck(app), describeEffects(app)};
    };
    return runProgram(argc, argv, "supercircle", "Supercircle: flexible open shells in 2D physics", describe,
                      kSiblings);
}
