#include "supercircle/support/cells.h"

#include <catch2/catch.hpp>

using namespace supercircle;

TEST_CASE("cells end at the commas outside parentheses") {
    using Cells = std::vector<std::string>;
    CHECK(cellsOutsideParentheses("x,code (0 free, 1 (new, old)),y\r") ==
          Cells{"x", "code (0 free, 1 (new, old))", "y"});
    CHECK(cellsOutsideParentheses("a,") == Cells{"a", ""});
    CHECK(cellsOutsideParentheses("") == Cells{""});
}
