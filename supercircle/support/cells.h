#pragma once
// Lines of the solved reference curves, which the tests of the core and the validation read.

#include <string>
#include <string_view>
#include <vector>

namespace supercircle {

/// Parts of `line` between the commas outside parentheses, in which names of columns explain codes. A carriage return
/// is left out.
inline std::vector<std::string> cellsOutsideParentheses(std::string_view line) {
    std::vector<std::string> cells(1);
    int depth = 0;
    for (const char c : line) {
        depth += c == '(' ? 1 : c == ')' ? -1 : 0;
        if (c == ',' && depth == 0)
            cells.emplace_back();
        else if (c != '\r')
            cells.back() += c;
    }
    return cells;
}

} // namespace supercircle
