#include "plugin/cli/sweep/sweep_play.h"

#include "bridge/box2d/lab_world.h"
#include "plugin/cli/input.h"
#include "plugin/cli/verbs.h"
#include "plugin/lab/session/runner.h"
#include "plugin/lab/sweep/run_result.h"
#include "plugin/lab/sweep/workers.h"
#include "plugin/scene/loader/loader.h"

#include <cstdio>
#include <memory>
#include <stdexcept>

namespace supercircle::cli {

std::string playOne(const std::string& sceneText, const std::string& sceneFile,
                    const std::vector<sweep::Setting>& settings, std::int64_t seed) {
    std::vector<scene::Problem> problems;
    const auto scene = loadWith(sceneText, sceneFile, settings, problems);
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
