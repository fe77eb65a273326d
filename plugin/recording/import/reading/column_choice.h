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

/// Units that no heading states: from the user, or asked for.
Status completeUnits(Draft& draft, const Hints& hints);

} // namespace supercircle::importing
