#pragma once
// The known name that somebody meant who wrote an unknown one.

#include <string>
#include <string_view>
#include <vector>

namespace supercircle {

/// The known name nearest to `name` by edit distance (insert, delete, replace, swap neighbours; case counts half of a
/// replacement); empty if more than a third of the letters differ (of two or three letters one may, of a single letter
/// its case), or if `name` has more than 64. Ties go to the first.
std::string nearestName(std::string_view name, const std::vector<std::string>& known);

/// `; did you mean "NAME"?` with the nearest known name, empty if there is none: the end of a message.
std::string didYouMean(std::string_view name, const std::vector<std::string>& known);

} // namespace supercircle
