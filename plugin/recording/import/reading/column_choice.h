#pragma once
// The best column for each quantity, and its unit (private to reading/).

#include "plugin/recording/import/signals.h"

#include <string_view>
#include <vector>

namespace supercircle::importing {

/// A table to be, with its lines.
struct Draft {
    const std::vector<std::string_view>& lines;
    Table table;
    std::vector<std::size_t> chosen; ///< column of each quantity that is used
    std::size_t wrong = 0;           ///< column that an error is about
};

/// The best of the columns that could be one quantity. Headings give a rank; columns of equal rank are scored by their
/// values: a clock runs on evenly, a sensor in use varies. Two that are proportional are one. Fails below 10 : 1.
Status chooseOne(Draft& draft, const std::vector<std::size_t>& candidates);

/// A column whose unit is none of its quantity is no candidate; without another one the unit is asked for.
Status checkUnit(Draft& draft, std::vector<std::size_t>& candidates);

/// Whether a column that is not used may be the time: its unit is one of time, or it has none and runs on evenly.
bool mayBeClock(const Draft& draft, std::size_t column);

/// --columns with what the headings say; a column whose unit is not known is taken in the usual one.
/// @param time column that is named the time; the number of columns: that of the headings
std::string columnsOf(const Table& table, std::size_t time);

/// Units that no heading states: from the user, or asked for.
Status completeUnits(Draft& draft, const Hints& hints);

} // namespace supercircle::importing
