#pragma once
// The laboratory: plays a scene - drop, settle, protocol of the testing machine - and records it.

#include "plugin/recording/table/recording.h"
#include "plugin/scene/loader/scene.h"
#include "supercircle/coulomb/solver.h"
#include "supercircle/step/port.h"
#include "supercircle/step/world.h"

#include <atomic>
#include <functional>
#include <memory>
#include <string>

namespace supercircle::lab {

/// Where a run stands, for progress lines.
struct Progress {
    std::string phase;
    double fraction = 0.0;     ///< of the whole run, 0 to 1, an estimate
    double simulated = 0.0;    ///< s
    double force = 0.0;        ///< N
    double displacement = 0.0; ///< m
};

struct Options {
    std::uint64_t seed = 1;
    int threads = 1;
    parallel::For loop;                            ///< threads of the caller's own (step::Stepper::loop)
    double fixedDt = 0.0;                          ///< s; > 0 overrides the scene's
    bool witness = true;                           ///< independent crossing check after each step
    bool frames = true;                            ///< keep the motion for the player
    std::function<void(const Progress&)> progress; ///< called now and then
    const std::atomic<bool>* interrupt = nullptr;  ///< becomes true: stop and keep what is done
    std::function<void(const coulomb::Problem&, const coulomb::SolveReport&)> onSolve; ///< every contact problem
    std::function<void(step::Stage)> onStage; ///< step::Stepper::watchStages; must not throw
};

enum class End : std::uint8_t { Done, BadScene, Failed, Interrupted };

struct Outcome {
    End end = End::Done;
    std::string message; ///< why, unless Done
    record::Recording recording;
};

/// Plays `scene` in `host` (built from scene.rigid).
Outcome run(const scene::Scene& scene, std::shared_ptr<step::HostWorld> host, const Options& options);

} // namespace supercircle::lab
