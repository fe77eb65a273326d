#pragma once
// Our own simulator in the second one's place: what a proof would look like that was made with the program's own
// physics (an ablation, docs/proof.md).

#include "tests/blind_benchmark/conceal/truth.h"

#include <string>
#include <vector>

namespace supercircle::oracle {

/// Flags with which `supercircle replay` simulates a case as it is in truth. Throws std::runtime_error if the answer
/// cannot be read or has an effect that replay does not take.
std::vector<std::string> truthFlags(const std::string& answerFile);

/// What `supercircle replay` wrote into a folder: the readings of `runs` runs. Throws std::runtime_error.
Clean replayed(const std::string& folder, std::size_t runs, bool markers);

} // namespace supercircle::oracle
