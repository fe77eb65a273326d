#pragma once
// Whole runs inside benchmarks.

#include "plugin/lab/session/runner.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Runs a scene of the project by name, without frames, until it is done or Ctrl-C.
/// @return empty, or why it could not be run
std::string runScene(const std::string& name, const std::vector<std::string>& parameters, lab::Options options,
                     lab::Outcome& out);

} // namespace supercircle::cli
