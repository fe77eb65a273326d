#pragma once
// Numbers as machines print them.

#include <cstdint>
#include <string_view>

namespace supercircle::importing {

enum class Cell : std::uint8_t { Number, Missing, Text };

/// How numbers are written in a file.
struct NumberStyle {
    char decimal = '.'; ///< '.' or ','
};

/// Reads a cell: 1234.5, -1.234,5, 1 234,5, 1'234.5, 1.2E-3, +3, a true minus sign, hh:mm:ss.s (in seconds; a date
/// before it is skipped, AM and PM count). Marks between groups of three digits other than the decimal mark are
/// understood. Empty cells,
/// "-", "nan", "n/a", "null" and the like are missing.
/// @param grouped set to true if groups of digits were marked; may be nullptr
Cell readCell(std::string_view cell, const NumberStyle& style, double& value, bool* grouped = nullptr);

} // namespace supercircle::importing
