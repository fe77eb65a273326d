#pragma once
// Metadata in the header of an export.

#include "plugin/recording/import/reading/layout.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::importing {

enum class MetadataKey : std::uint8_t { Rate, Speed, PeakForce, Rows, Width, Thickness };

struct MetadataValue {
    double value = 0.0; ///< Hz, m/s, N, rows, m
    std::size_t line = 0;
    bool unitStated = true; ///< false: a rate without a unit
};

struct StatedValue {
    MetadataValue value;
    std::string key; ///< as it stands in the header
};

/// First header entry with this metadata: "Sample rate: 100 Hz", "Test speed;5;mm/min", "Fmax [N] = 3,2", "Number of
/// points: 500". Only positive numbers with a suitable unit count; a sampling rate may have none.
/// A speed is that of the test: none if several may be, or if all belong to other phases ("Return speed"). Widths of
/// grips are none of the specimen.
[[nodiscard]] std::optional<MetadataValue> metadataValue(const std::vector<HeaderEntry>& metadata, MetadataKey what);

/// Speeds of which none is clearly that of the test; empty: one is, or there are none.
[[nodiscard]] std::vector<StatedValue> unclearSpeeds(const std::vector<HeaderEntry>& metadata);

} // namespace supercircle::importing
