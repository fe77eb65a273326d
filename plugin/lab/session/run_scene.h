#pragma once
// One simulated experiment: a scene (drop, settle, test protocol) and its recording.

#include "plugin/lab/session/checkpoint.h"
#include "plugin/recording/table/recording.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/step/port.h"
#include "supercircle/step/world.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace supercircle::lab {

/// Where a run stands, for progress lines.
struct RunProgress {
    std::string phase;
    double fraction = 0.0;     ///< of the whole run, 0 to 1, an estimate
    double simulated = 0.0;    ///< s
    double force = 0.0;        ///< N
    double displacement = 0.0; ///< m
};

struct RunOptions {
    std::uint64_t seed = 1;
    int threads = 1;
    parallel::For loop;                               ///< replaces the stepper's own threads (step::Stepper::loop)
    double fixedDt = 0.0;                             ///< s; > 0 overrides the scene's
    std::optional<scene::Accuracy> accuracy;          ///< overrides the scene's
    bool crossingCheck = true;                        ///< independent crossing check after each step
    bool keepFrames = true;                           ///< record the motion for the player
    std::function<void(const RunProgress&)> progress; ///< called from time to time
    const std::atomic<bool>* interrupt = nullptr;     ///< becomes true: stop and return what is done
    CheckpointOptions checkpoint;
    std::function<void(const coulomb::Problem&, const coulomb::SolveReport&)> onSolve; ///< every contact problem
    std::function<void(step::Stage)> onStage; ///< step::Stepper::watchStages; must not throw
};

enum class RunStatus : std::uint8_t { Done, BadScene, Failed, Interrupted };

struct RunResult {
    RunStatus status = RunStatus::Done;
    std::string message; ///< why, unless Done
    record::Recording recording;
};

/// Simulates `scene` in `host` (built from scene.rigid).
RunResult runScene(const scene::Scene& scene, std::shared_ptr<step::HostWorld> host, const RunOptions& options);

} // namespace supercircle::lab
