#include "plugin/cli/sweep_play.h"

#include "bridge/lab_world.h"
#include "plugin/cli/verbs.h"
#include "plugin/lab/runner.h"
#include "plugin/scene/loader.h"
#include "plugin/sweep/run_result.h"
#include "plugin/sweep/workers.h"

#include <cstdio>
#include <memory>
#include <stdexcept>

namespace supercircle::cli {

namespace {

std::optional<scene::Scene> loaded(const std::string& text, const std::string& file,
                                   const std::vector<sweep::Setting>& settings, std::vector<scene::Problem>& problems) {
    std::vector<scene::Override> overrides;
    for (const auto& [name, value] : settings)
        overrides.push_back({name, value});
    return scene::loadText(text, file, overrides, problems);
}

} // namespace

bool canStart(const std::string& sceneText, const std::string& sceneFile, const std::vector<sweep::Setting>& settings) {
    std::vector<scene::Problem> problems;
    const auto scene = loaded(sceneText, sceneFile, settings, problems);
    for (const scene::Problem& p : problems)
        if (p.severity == scene::Problem::Severity::Error)
            std::fprintf(stderr, "%s\n", p.toString().c_str());
    std::string why;
    if (scene && bridge::makeWorld(scene->rigid, why))
        return true;
    if (scene)
        std::fprintf(stderr, "%s: %s\n", sceneFile.c_str(), why.c_str());
    std::fprintf(stderr, "%s: not with %s\n", sceneFile.c_str(), sweep::keyOf(settings).c_str());
    return false;
}

std::string playOne(const std::string& sceneText, const std::string& sceneFile,
                    const std::vector<sweep::Setting>& settings, std::int64_t seed) {
    std::vector<scene::Problem> problems;
    const auto scene = loaded(sceneText, sceneFile, settings, problems);
    std::string why = "the scene cannot be loaded";
    std::shared_ptr<step::HostWorld> host = scene ? bridge::makeWorld(scene->rigid, why) : nullptr;
    if (!host)
        throw std::runtime_error(why);
    lab::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.frames = false;
    options.interrupt = &interrupted;
    const lab::Outcome out = lab::run(*scene, host, options);
    if (out.end == lab::End::Interrupted)
        throw sweep::Stopped{};
    if (out.end == lab::End::BadScene)
        throw std::runtime_error(out.message);
    return sweep::packed(sweep::resultOf(out.recording, out.end == lab::End::Done ? "done" : "failed", out.message));
}

} // namespace supercircle::cli
