#pragma once
// What a description does not state but what it states implies (private to importing/).

#include "plugin/recording/import/import.h"

#include <string>
#include <vector>

namespace supercircle::importing {

/// The description (JSON text, an object) with bending moduli E w h^3 / 12 and the height of the head at displacement
/// 0, from the first touch, where they follow from what it states; each is said in `remarks`.
std::string workedOut(const std::string& description, const Imported& all, std::vector<std::string>& remarks);

} // namespace supercircle::importing
