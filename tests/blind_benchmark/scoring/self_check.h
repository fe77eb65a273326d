#pragma once
// This project's simulator in place of the reference simulator: an ablation of the benchmark
// (docs/results/diagnosis.md).

#include "tests/blind_benchmark/synthetic_cases/detectability.h"

#include <string>
#include <vector>

namespace supercircle::blind_benchmark {

/// Options with which `supercircle replay` simulates a case with its true parameters and effects. Throws
/// std::runtime_error if the answer cannot be read or has an effect that replay does not accept.
std::vector<std::string> truthFlags(const std::string& answerFile);

/// Reads the results of `supercircle replay` for `runs` runs. Throws std::runtime_error.
CleanReadings replayed(const std::string& folder, std::size_t runs, bool markers);

} // namespace supercircle::blind_benchmark
