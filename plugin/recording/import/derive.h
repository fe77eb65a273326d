#pragma once
// What a description does not state but what it states implies (private to importing/).

#include "plugin/recording/import/import.h"

#include <string>
#include <vector>

namespace supercircle::importing {

/// Adds derived values to the description (JSON text, an object): bending moduli E w h^3 / 12, and the height of the
/// crosshead at displacement 0 from first contact. Each is reported in `remarks`.
std::string withDerivedValues(const std::string& description, const Imported& all, std::vector<std::string>& remarks);

} // namespace supercircle::importing
