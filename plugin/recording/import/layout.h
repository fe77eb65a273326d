#pragma once
// Where in an export the table is and how it is written.

#include "plugin/recording/import/number.h"
#include "plugin/recording/table/result.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::importing {

/// A line of the header that says something: "Test speed: 5 mm/min".
struct Metadata {
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
    std::vector<Metadata> metadata;        ///< of the lines above
    bool decimalAssumed = false;           ///< "1.234" could be meant with either mark
};

/// Finds separator, decimal mark, table and headings: of all ways to read the lines the one that gives most rows of
/// numbers with the same number of cells.
/// @return the layout, or why there is no table
record::Result<Layout> layoutOf(const std::vector<std::string_view>& lines);

/// Cells of a line as the layout has them; a separator at the end of the line makes no cell.
std::vector<std::string> cellsOf(std::string_view line, const Layout& layout);

/// "comma", "semicolon", "tab", "blanks"
const char* separatorName(char separator);

} // namespace supercircle::importing
