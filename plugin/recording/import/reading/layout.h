#pragma once
// Position and format of the table in an export.

#include "plugin/recording/import/reading/number.h"
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

/// What was decided, and what would have been next.
struct Decision {
    std::string question, answer, runnerUp;
    double odds = 0.0;  ///< of the answer against the runner-up; 0: stated, or a rule
    std::string option; ///< that decides otherwise
};

struct Layout {
    std::vector<Decision> decisions;
    char separator = ','; ///< ' ': runs of blanks
    NumberStyle numbers;  ///< of most columns
    std::size_t columns = 0;
    std::vector<NumberStyle> styles;       ///< per column: a file may hold decimal commas beside decimal points
    std::vector<bool> numeric;             ///< columns that hold numbers
    std::size_t namesLine = 0;             ///< from 1; 0: there is none
    std::size_t unitsLine = 0;             ///< from 1; 0: there is none
    std::size_t firstDataLine = 0;         ///< from 1
    std::vector<std::string> names, units; ///< per column; empty where there is no such line
    std::vector<std::string> titles;       ///< per column, of the line above the names: names of specimens
    std::vector<HeaderEntry> metadata;     ///< of the lines above
    bool decimalAssumed = false;           ///< "1.234" could be meant with either mark
};

/// Finds separator, decimal marks, table and headings, by the largest number of numeric rows with equal numbers of
/// cells.
/// @return the layout, or an error
Result<Layout> layoutOf(const std::vector<std::string_view>& lines);

/// Lines spread over a file that decide about its form.
std::vector<std::size_t> sampledLines(std::size_t lines);

/// Whether the cells are a row of the table: numbers in the columns of numbers, or nothing.
bool isRow(const std::vector<std::string>& cells, const Layout& layout);

/// Cells of a line in this layout. Empty cells behind the last column are dropped; a row that ends behind its last
/// number is filled up.
std::vector<std::string> cellsOf(std::string_view line, const Layout& layout);

/// "comma", "semicolon", "tab", "blanks"
const char* separatorName(char separator);

} // namespace supercircle::importing
