#pragma once
// The member "replay" of a diagnosis.json.

#include "plugin/identification/diagnosis/stored_fits.h"

#include <string>

namespace supercircle::cli {

/// As JSON text. Numbers have all digits.
std::string storedFitsJson(const diagnosis::StoredFits& fits);

/// Reads that member from a diagnosis.json; or what is wrong and what helps.
Result<diagnosis::StoredFits> readStoredFits(const std::string& file);

} // namespace supercircle::cli
