#pragma once
// The motion as compact JSON for the page's player (format: decision 0177).

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "plugin/recording/table/recording.h"

namespace supercircle::pages {

/// Base64 of bytes (RFC 4648, with padding).
[[nodiscard]] std::string base64(std::span<const unsigned char> bytes);

/// Turning of every element as a multiple of `unit` (rad), rounded so that the errors of the running sum never add up:
/// the tangent angle after any element is right within unit / 2.
[[nodiscard]] std::vector<int> quantisedTurns(const std::vector<double>& turns, double unit);

/// Frames that fit into about `budget` bytes: all, or every k-th, always with the first, the last and the key frames.
[[nodiscard]] std::vector<std::size_t> keptFrames(const record::Recording& recording, std::size_t budget);

/// JSON object with typed arrays in base64 (little endian). Safe inside <script>.
[[nodiscard]] std::string motionJson(const record::Recording& recording, const std::vector<std::size_t>& frames);

} // namespace supercircle::pages
