#pragma once
// The units that exports state, and how they are written (private to the reading of exports).

#include "plugin/recording/import/reading/quantity.h"

namespace supercircle::importing {

/// @param named quantity that the words beside the unit name; None: there are none
Unit unitFor(std::string_view text, Quantity named);
/// A unit in any letters.
bool isUnit(std::string_view text);

} // namespace supercircle::importing
