#pragma once
// What a sweep stores of one run: the summary, the timing apart from it because it depends on the computer, and a
// thinned force curve.

#include "plugin/recording/table/recording.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supercircle::sweep {

/// One loading or unloading branch, thinned: displacement (m) and force (N) of equal lengths.
struct CurveBranch {
    std::vector<double> displacement, force;
};

struct RunRecord {
    std::string status;  ///< "done", "failed" (could not continue), "crashed" (the process died)
    std::string message; ///< why, unless done
    std::vector<std::pair<std::string, record::Value>> summary; ///< in the order of summary.json, energy_... appended
    std::vector<std::pair<std::string, double>> timing;         ///< s, depends on the computer
    std::vector<record::Cycle> cycles;
    std::vector<CurveBranch> branches;
};

/// @param status "done" or "failed"
[[nodiscard]] RunRecord recordOf(const record::Recording& recording, const std::string& status,
                                 const std::string& message);

/// To JSON text and back; the same record gives the same bytes. Reading an incomplete text gives nothing.
[[nodiscard]] std::string serialise(const RunRecord& run);
[[nodiscard]] std::optional<RunRecord> deserialise(std::string_view text);

} // namespace supercircle::sweep
