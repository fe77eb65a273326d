#pragma once
// Runs on a cluster: shards are the tasks of a Slurm job array, each a sweep into its own folder.

#include "supercircle/support/result.h"

#include <optional>
#include <string>
#include <vector>

namespace supercircle::sweep {

/// Result of a program that was started and waited for.
struct ProgramOutput {
    int code = -1; ///< exit code; 127: could not be started; 128 + signal
    std::string out, err;
};

/// Starts a program found on PATH, without a shell: arguments arrive unchanged.
[[nodiscard]] ProgramOutput runCommand(const std::vector<std::string>& command);

/// A job array of this user.
struct ArrayJob {
    std::string id;
    std::string name;
    int parts = 0; ///< number of tasks
};

/// Name prefix of all arrays of a folder; the number of tasks is appended.
[[nodiscard]] std::string arrayName(const std::string& folder);

/// The array whose name begins with `name`, pending or running; empty if there is none.
[[nodiscard]] Result<std::optional<ArrayJob>> findArray(const std::string& name);

/// A shell script that runs `command` for one task; "@TASK@" and "@TASKS@" in its arguments become the
/// task's number and the number of tasks.
[[nodiscard]] std::string arrayScript(const std::vector<std::string>& command, int parts, const std::string& log);

/// Submits a script as an array of `parts` tasks. @return the job's number
[[nodiscard]] Result<std::string> submitArray(const std::string& script, const std::string& name, int parts,
                                              const std::vector<std::string>& options);

} // namespace supercircle::sweep
