#include "plugin/cli/sweep/sweep_run.h"

#include "bridge/box2d/lab_world.h"
#include "plugin/cli/subcommands.h"
#include "plugin/cli/sweep/sweep_input.h"
#include "plugin/lab/session/run_scene.h"
#include "plugin/lab/sweep/run_record.h"
#include "plugin/lab/sweep/workers.h"
#include "plugin/scene/loader/loader.h"

#include <cstdio>
#include <memory>
#include <stdexcept>

namespace supercircle::cli {

std::string runOne(const std::string& sceneText, const std::string& sceneFile,
                   const std::vector<sweep::ParameterValue>& values, std::int64_t seed,
                   std::optional<scene::Accuracy> accuracy) {
    std::vector<scene::Problem> problems;
    const auto scene = loadWithParameters(sceneText, sceneFile, values, problems);
    std::string why = "the scene cannot be loaded";
    std::shared_ptr<step::HostWorld> host = scene ? bridge::makeWorld(scene->rigid, why) : nullptr;
    if (!host)
        throw std::runtime_error(why);
    lab::RunOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    options.keepFrames = false;
    options.accuracy = accuracy;
    options.interrupt = &interrupted;
    const lab::RunResult out = lab::runScene(*scene, host, options);
    if (out.status == lab::RunStatus::Interrupted)
        throw sweep::TaskInterrupted{};
    if (out.status == lab::RunStatus::BadScene)
        throw std::runtime_error(out.message);
    return sweep::serialise(
        sweep::recordOf(out.recording, out.status == lab::RunStatus::Done ? "done" : "failed", out.message));
}

} // namespace supercircle::cli
