#include "plugin/bench/bench.h"
#include "plugin/bench/bench_scene_run.h"
#include "plugin/cli/data_folders.h"
#include "plugin/cli/input.h"
#include "plugin/cli/subcommands.h"

#include <filesystem>

namespace supercircle::cli {

namespace {

/// scenes/NAME.json below the current directory, else in the folder of the project's scenes.
std::string sceneFile(const std::string& name) {
    const std::string here = "scenes/" + name + ".json";
    std::error_code error;
    return std::filesystem::exists(here, error) ? here : scenesFolder() + "/" + name + ".json";
}

double figure(const record::Recording& recording, const std::string& key) {
    for (const auto& [name, value] : recording.summary)
        if (name == key) {
            if (const auto* d = std::get_if<double>(&value))
                return *d;
            if (const auto* i = std::get_if<std::int64_t>(&value))
                return static_cast<double>(*i);
        }
    return 0.0;
}

std::string measureScene(const std::string& name, const std::string& scene, const std::vector<std::string>& parameters,
                         int times, const std::function<void(Measurement)>& done) {
    std::vector<double> samples;
    std::vector<std::pair<std::string, double>> more;
    for (int i = 0; i < times && !interrupted; ++i) {
        lab::RunResult out;
        std::string error;
        const double ms = timed([&] { error = runBenchmarkScene(scene, parameters, {}, out); });
        if (!error.empty())
            return error;
        if (out.status != lab::RunStatus::Done)
            break; // interrupted: an incomplete run is not measured
        samples.push_back(ms);
        more = {{"steps", figure(out.recording, "steps")},
                {"unconverged", figure(out.recording, "unconverged_steps")},
                {"simulated_s", figure(out.recording, "simulated_s")}};
    }
    if (samples.empty())
        return {};
    Measurement m = summarise(name, std::move(samples));
    m.more = std::move(more);
    done(std::move(m));
    return {};
}

} // namespace

std::string runBenchmarkScene(const std::string& name, const std::vector<std::string>& parameters,
                              lab::RunOptions options, lab::RunResult& out) {
    const std::string file = sceneFile(name);
    const auto input = loadScene(file, parameters, true);
    if (!input)
        return "the benchmark scene " + file + " cannot be read";
    if (options.interrupt == nullptr)
        options.interrupt = &interrupted;
    options.keepFrames = false;
    out = lab::runScene(input->scene, input->host, options);
    if (out.status == lab::RunStatus::BadScene || out.status == lab::RunStatus::Failed)
        return file + ": " + out.message;
    return {};
}

void addSceneBenchmarks(std::vector<Benchmark>& all) {
    const auto add = [&](const std::string& name, const std::string& scene, const std::vector<std::string>& parameters,
                         int times, bool onRequest) {
        all.push_back({{name}, onRequest, [=](const auto& wanted, const auto& done) {
                           return wanted(name) ? measureScene(name, scene, parameters, times, done) : std::string();
                       }});
    };
    add("shell_on_cylinder", "shell_on_cylinder", {}, 10, false);
    add("stack8", "stack30", {"shells=8"}, 3, false);
    add("stack30", "stack30", {}, 1, true);
}

} // namespace supercircle::cli
