#pragma once
// The member "replay" of a diagnosis.json.

#include "plugin/identification/diagnosis/stored_fits.h"

#include <string>
#include <vector>

namespace supercircle::cli {

/// As JSON text. Numbers have all digits.
std::string storedFitsJson(const diagnosis::StoredFits& fits);

/// Reads that member from a diagnosis.json; or what is wrong and what helps.
Result<diagnosis::StoredFits> readStoredFits(const std::string& file);

/// What a replay took from a diagnosis.
struct Taken {
    std::string label;
    std::vector<std::string> notes; ///< of a carried law, in this section
};

/// Sets parameters and effects to a fit of this experiment's diagnosis, or only the effects to the law of another
/// one's (`carried`); or what is wrong.
/// @param label empty: the drawn fit
Result<Taken> takeFit(const std::string& file, const std::string& label, bool carried,
                      const experiment::Experiment& experiment, replay::Parameters& parameters);

} // namespace supercircle::cli
