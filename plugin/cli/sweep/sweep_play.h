#pragma once
// One run of a sweep, as the process that plays it sees it.

#include "plugin/lab/sweep/definition.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// Plays it and packs what came out (sweep::packed). Throws sweep::Stopped when interrupted, std::runtime_error when
/// the scene cannot be started.
std::string playOne(const std::string& sceneText, const std::string& sceneFile,
                    const std::vector<sweep::Setting>& settings, std::int64_t seed);

} // namespace supercircle::cli
