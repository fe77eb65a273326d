#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/sibling.h"
#include "plugin/cli/subcommands.h"

#include "plugin/lab/session/run_scene.h"

#include <cmath>
#include <cstdio>

namespace supercircle::cli {

namespace {

std::string range(const scene::Parameter& p) {
    char text[96];
    if (std::isfinite(p.min) && std::isfinite(p.max))
        std::snprintf(text, sizeof text, "%g to %g", p.min, p.max);
    else if (std::isfinite(p.min))
        std::snprintf(text, sizeof text, "from %g", p.min);
    else if (std::isfinite(p.max))
        std::snprintf(text, sizeof text, "up to %g", p.max);
    else
        return "any";
    return text;
}

} // namespace

int check(const std::string& file, const std::vector<std::string>& parameters) {
    const std::string schema = schemaOf(file);
    std::vector<std::string> words{"check", file};
    for (const std::string& p : parameters)
        words.insert(words.end(), {"--param", p});
    if (allowOutside && schema.rfind("rod-recordings/", 0) == 0)
        words.emplace_back("--allow-outside");
    if (schema.rfind("rod-recordings/", 0) == 0)
        return startSibling("check", "supercircle-identify", words);
    if (schema.rfind("supercircle-sweep/", 0) == 0)
        return startSibling("check", "supercircle-lab", words);
    const auto input = loadScene(file, parameters, false, true);
    if (!input)
        return kBadInput;
    const scene::Scene& scene = input->scene;
    const bool mechanism = scene::isMechanism(scene);
    // Only a session can tell whether the start is free of overlaps: it is interrupted before the first step.
    const std::atomic<bool> interrupt{true};
    lab::RunOptions options;
    options.interrupt = &interrupt;
    options.keepFrames = false;
    if (const lab::RunResult out = mechanism ? lab::RunResult{} : lab::runScene(scene, input->host, options);
        out.status == lab::RunStatus::BadScene) {
        std::fprintf(stderr, "%s: %s\n", file.c_str(), out.message.c_str());
        return kBadInput;
    }
    const auto count = [](std::size_t n, const char* what) {
        return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
    };
    const std::string dropped = scene.drop ? " and " + std::to_string(scene.drop->count) + " dropped" : "";
    std::printf(
        "%s: valid scene (%s%s, %s, %s)\n", file.c_str(), count(scene.shells.size(), "shell").c_str(), dropped.c_str(),
        scene.rigid.bodies.size() == 1 ? "1 body" : (std::to_string(scene.rigid.bodies.size()) + " bodies").c_str(),
        count(scene.parameters.size(), "parameter").c_str());
    if (mechanism)
        std::printf("  a mechanism for experiments: `replay` and `diagnose` simulate it, `run` does not\n");
    for (const scene::Parameter& p : scene.parameters)
        std::printf("  %-16s %-10.6g %-18s %-4s %s\n", p.name.c_str(), p.value, range(p).c_str(), p.unit.c_str(),
                    p.about.c_str());
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
