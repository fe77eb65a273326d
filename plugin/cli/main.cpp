#include "plugin/cli/verbs.h"

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

namespace supercircle::cli {
std::atomic<bool> interrupted{false};
}

namespace {

void onInterrupt(int) {
    supercircle::cli::interrupted = true;
    std::signal(SIGINT, SIG_DFL); // a second Ctrl-C ends the program at once
}

} // namespace

int main(int argc, char** argv) {
    using namespace supercircle::cli;
    CLI::App app{"Supercircle: flexible open shells in 2D physics"};
    app.set_version_flag("--version", SC_VERSION);
    app.require_subcommand(1);

    RunArguments run_;
    CLI::App* run = app.add_subcommand("run", "simulate a scene and write summary, series, pictures and report");
    run->add_option("scene", run_.scene, "scene file (JSON)")->required();
    run->add_option("--param", run_.parameters, "NAME=VALUE: set a parameter of the scene (repeatable)")->take_all();
    run->add_option("--seed", run_.seed, "seed of everything random")->capture_default_str();
    run->add_option("--out", run_.out, "folder for the results (default: out/<scene>)");
    run->add_option("--threads", run_.threads, "threads; the digits do not depend on it")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    run->add_option("--fixed-dt", run_.fixedDt, "fixed time step in seconds instead of the adaptive one")
        ->check(CLI::PositiveNumber);
    run->add_flag("--no-report", run_.noReport, "summary.json and series.csv only");
    run->add_flag("--quiet", run_.quiet, "no progress");
    run->add_option("--dump", run_.dump, "folder that receives the contact problems as FCP2D files");

    std::string file;
    std::vector<std::string> parameters;
    CLI::App* check = app.add_subcommand("check", "validate a scene without running it");
    check->add_option("file", file, "scene file (JSON)")->required();
    check->add_option("--param", parameters, "NAME=VALUE")->take_all();

    std::string filter, json;
    CLI::App* bench = app.add_subcommand("bench", "measure speed and memory");
    bench->add_option("--filter", filter, "only benchmarks whose name contains this");
    bench->add_option("--json", json, "write the figures to this file");

    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp& e) {
        return app.exit(e);
    } catch (const CLI::CallForAllHelp& e) {
        return app.exit(e);
    } catch (const CLI::CallForVersion& e) {
        return app.exit(e);
    } catch (const CLI::ParseError& e) {
        app.exit(e);
        return kBadInput;
    }
    std::signal(SIGINT, onInterrupt);
    std::signal(SIGTERM, onInterrupt);
    if (run->parsed())
        return supercircle::cli::run(run_);
    if (check->parsed())
        return supercircle::cli::check(file, parameters);
    return supercircle::cli::bench(filter, json);
}
