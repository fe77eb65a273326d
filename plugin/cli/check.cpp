#include "plugin/cli/input.h"
#include "plugin/cli/output.h"
#include "plugin/cli/verbs.h"

#include "plugin/lab/runner.h"

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
    const auto input = loadScene(file, parameters);
    if (!input)
        return kBadInput;
    // Whether the start is free of overlaps only the laboratory knows: it is told to stop before the first step.
    const std::atomic<bool> atOnce{true};
    lab::Options options;
    options.interrupt = &atOnce;
    options.frames = false;
    const scene::Scene& scene = input->scene;
    if (const lab::Outcome out = lab::run(scene, input->host, options); out.end == lab::End::BadScene) {
        std::fprintf(stderr, "%s: %s\n", file.c_str(), out.message.c_str());
        return kBadInput;
    }
    const auto count = [](std::size_t n, const char* what) {
        return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
    };
    const std::string dropped = scene.drop ? " and " + std::to_string(scene.drop->count) + " dropped" : "";
    std::printf(
        "%s: a good scene (%s%s, %s, %s)\n", file.c_str(), count(scene.shells.size(), "shell").c_str(), dropped.c_str(),
        scene.rigid.bodies.size() == 1 ? "1 body" : (std::to_string(scene.rigid.bodies.size()) + " bodies").c_str(),
        count(scene.parameters.size(), "parameter").c_str());
    for (const scene::Parameter& p : scene.parameters)
        std::printf("  %-16s %-10.6g %-18s %-4s %s\n", p.name.c_str(), p.value, range(p).c_str(), p.unit.c_str(),
                    p.about.c_str());
    return printed() ? kDone : kCannotWrite;
}

} // namespace supercircle::cli
