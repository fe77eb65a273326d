#pragma once
// Decimal marks that a spreadsheet took for marks of thousands (private to reading/).

#include "plugin/recording/import/signals.h"

#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::importing {

/// Lines of a table with other decimal marks.
struct MarkedLines {
    std::vector<std::string_view> lines; ///< of the file; those that were changed are views of `texts`
    std::deque<std::string> texts;
    std::vector<Remark> remarks;
    std::vector<Decision> decisions;
};

/// A spreadsheet in another language reads "33.3973" as 333973 and writes "333,973": digits stay, marks do not. Cells
/// that cannot be groups of three digits, "34,13", are right. The others get the marks with which the column runs on
/// smoothly from these. Only columns that jump, or that hold cells of several marks, are looked at.
/// @param t as read; columns of one specimen
/// @return no lines if nothing is to be placed, or too few cells are right
MarkedLines placeDecimalMarks(const std::vector<std::string_view>& lines, const Table& t);

} // namespace supercircle::importing
