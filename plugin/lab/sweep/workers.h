#pragma once
// Runs in separate processes, several at a time: a crash of one does not stop the others (decision 0174).

#include "plugin/lab/sweep/definition.h"

#include <atomic>
#include <functional>
#include <string>
#include <vector>

namespace supercircle::sweep {

/// How the process of a run ended.
struct FinishedTask {
    Task task;
    std::string result;           ///< what it returned
    int exitCode = 0;             ///< 0 on success
    int signal = 0;               ///< that ended it, 0: none
    double wall = 0.0, cpu = 0.0; ///< s
};

struct WorkPlan {
    int jobs = 1;                                    ///< processes at a time
    const std::atomic<bool>* interrupt = nullptr;    ///< becomes true: stop the processes and return
    std::function<std::string(const Task&)> runTask; ///< executes one run, in its own process
    std::function<std::string(const FinishedTask&)>
        onFinished;               ///< stores one; a text it returns is an error and ends the work
    std::function<void()> onPoll; ///< called about ten times a second
    std::function<void()> onFork; ///< first call in every child process: releases the parent's resources
};

/// Exit code of a process whose runTask() threw.
inline constexpr int kExitException = 70;
/// Exit code of a process that was interrupted: its run is not finished.
inline constexpr int kExitInterrupted = 130;
/// To be thrown by runTask() when it was interrupted.
struct TaskInterrupted {};

/// Runs `tasks` in order. Must be called from a program without other threads (fork). The child processes end with this
/// one.
/// @return empty, or why the work ended early (not for an interrupt)
[[nodiscard]] std::string runTasks(const std::vector<Task>& tasks, const WorkPlan& work);

} // namespace supercircle::sweep
