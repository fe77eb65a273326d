#pragma once
// Runs of scenes in benchmarks.

#include "plugin/lab/session/run_scene.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Runs a scene of the project by name, without frames, until it is done or interrupted.
/// @return empty, or why it could not be run
[[nodiscard]] std::string runBenchmarkScene(const std::string& name, const std::vector<std::string>& parameters,
                                            lab::RunOptions options, lab::RunResult& out);

} // namespace supercircle::cli
