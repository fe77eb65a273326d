#pragma once
// Runs in processes of their own, several at a time: whatever happens to one, the others and the sweep go on.

#include "plugin/lab/sweep/definition.h"

#include <atomic>
#include <functional>
#include <string>
#include <vector>

namespace supercircle::sweep {

/// How the process of a run ended.
struct Finished {
    Task task;
    std::string result;           ///< what it handed over
    int exitCode = 0;             ///< 0 when it arrived at its end
    int signal = 0;               ///< that ended it, 0: none
    double wall = 0.0, cpu = 0.0; ///< s
};

struct Work {
    int jobs = 1;                                         ///< processes at a time
    const std::atomic<bool>* interrupt = nullptr;         ///< becomes true: stop the processes and return
    std::function<std::string(const Task&)> play;         ///< plays one run, in a process of its own
    std::function<std::string(const Finished&)> finished; ///< keeps one; what it returns, unless empty, ends the work
    std::function<void()> turn;                           ///< called now and then
    std::function<void()> child;                          ///< first thing in every process: let go of what is ours
};

/// Exit code of a process whose play() threw.
inline constexpr int kThrew = 70;
/// Exit code of a process that was interrupted: its run is not finished.
inline constexpr int kStopped = 130;
/// To be thrown by play() when it was interrupted.
struct Stopped {};

/// Plays `tasks` in order. Must be called from a program without other threads (fork). The processes end when this one
/// does, however it ends.
/// @return empty, or why the work ended early (not for an interrupt)
[[nodiscard]] std::string playAll(const std::vector<Task>& tasks, const Work& work);

} // namespace supercircle::sweep
