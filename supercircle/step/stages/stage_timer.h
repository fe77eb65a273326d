#pragma once
// Wall time per stage (private to step/).

#include "supercircle/step/stepper.h"

#include <chrono>

namespace supercircle::step {

/// Adds the wall time of its life to one stage.
class StageTimer {
public:
    StageTimer(StageTimes& times, Stage stage)
        : times_(times), stage_(stage), start_(std::chrono::steady_clock::now()) {
        if (times_.onStage)
            times_.onStage(stage_);
    }
    ~StageTimer() {
        times_[static_cast<std::size_t>(stage_)] +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        if (times_.onStage)
            times_.onStage(Stage::Count);
    }
    StageTimer(const StageTimer&) = delete;
    StageTimer& operator=(const StageTimer&) = delete;

private:
    StageTimes& times_;
    Stage stage_;
    std::chrono::steady_clock::time_point start_;
};

/// Calls `work` and adds its wall time to `stage`.
template <class Work>
auto timed(StageTimes& times, Stage stage, Work&& work) {
    const StageTimer timer(times, stage);
    return work();
}

} // namespace supercircle::step
