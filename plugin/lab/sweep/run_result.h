#pragma once
// What a sweep keeps of one run: numbers that depend on the input alone, apart from those that depend on the machine,
// and a thinned force curve.

#include "plugin/recording/table/recording.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace supercircle::sweep {

/// One way of the machine, displacement (m) and force (N) of equal lengths, thinned.
struct Leg {
    std::vector<double> displacement, force;
};

struct RunResult {
    std::string status;  ///< "done", "failed" (could not go on), "crashed" (the process died)
    std::string message; ///< why, unless done
    std::vector<std::pair<std::string, record::Value>> summary; ///< in the order of summary.json, energy_... appended
    std::vector<std::pair<std::string, double>> timings;        ///< s, of this machine and this day
    std::vector<record::Cycle> cycles;
    std::vector<Leg> curve;
};

/// @param status "done" or "failed"
[[nodiscard]] RunResult resultOf(const record::Recording& recording, const std::string& status,
                                 const std::string& message);

/// As one JSON text and back; the same result gives the same bytes. Reading is empty if the text is torn.
[[nodiscard]] std::string packed(const RunResult& result);
[[nodiscard]] std::optional<RunResult> unpacked(std::string_view text);

} // namespace supercircle::sweep
