#pragma once
// Units beside the numbers, "0,10 s;0,00 mm;0,01 N" (private to reading/).

#include "supercircle/support/result.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::importing {

/// Lines without the units of their cells.
struct BareLines {
    std::vector<std::string> lines; ///< all of the file; empty: no units stand beside its numbers
    char separator = ';';
    std::size_t first = 0;          ///< line with units, from 1
    std::vector<std::string> units; ///< of each cell
};

/// Takes the units off the numbers, if that makes a table of lines that are none with them. Fails where a column
/// changes its unit: "LINE:1: ...".
Result<BareLines> takeUnitsOff(const std::vector<std::string_view>& lines);

} // namespace supercircle::importing
