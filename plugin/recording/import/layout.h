#pragma once
// Position and format of the table in an export.

#include "plugin/recording/import/number.h"
#include "supercircle/support/result.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::importing {

/// An entry of the header: "Test speed: 5 mm/min".
struct HeaderEntry {
    std::size_t line = 0; ///< from 1
    std::string key, value;
};

struct Layout {
    char separator = ','; ///< ' ': runs of blanks
    NumberStyle numbers;
    std::size_t columns = 0;
    std::vector<bool> numeric;             ///< columns that hold numbers
    std::size_t namesLine = 0;             ///< from 1; 0: there is none
    std::size_t unitsLine = 0;             ///< from 1; 0: there is none
    std::size_t firstDataLine = 0;         ///< from 1
    std::vector<std::string> names, units; ///< per column; empty where there is no such line
    std::vector<HeaderEntry> metadata;     ///< of the lines above
    bool decimalAssumed = false;           ///< "1.234" could be meant with either mark
};

/// Finds separator, decimal mark, table and headings, by the largest number of numeric rows with equal numbers of
/// cells.
/// @return the layout, or an error
Result<Layout> layoutOf(const std::vector<std::string_view>& lines);

/// Cells of a line in this layout; a separator at the end makes no cell.
std::vector<std::string> cellsOf(std::string_view line, const Layout& layout);

/// "comma", "semicolon", "tab", "blanks"
const char* separatorName(char separator);

} // namespace supercircle::importing
