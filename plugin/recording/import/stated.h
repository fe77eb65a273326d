#pragma once
// What the header of an export says about the test as a whole.

#include "plugin/recording/import/layout.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace supercircle::importing {

enum class Stated : std::uint8_t { Rate, Speed, PeakForce, Rows };

struct Statement {
    double value = 0.0; ///< Hz, m/s, N, rows
    std::size_t line = 0;
    bool unitStated = true; ///< false: a rate without a unit
};

/// The first line of the header that states it: "Sample rate: 100 Hz", "Test speed;5;mm/min", "Fmax [N] = 3,2",
/// "Number of points: 500". Only positive numbers with a unit that fits count; a sample rate may be without.
std::optional<Statement> stated(const std::vector<Metadata>& metadata, Stated what);

} // namespace supercircle::importing
