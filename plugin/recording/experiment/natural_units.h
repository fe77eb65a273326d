#pragma once
// Units in which set-ups of one kind look alike, whatever their size, stiffness and mass (decision 0190).

#include "plugin/recording/experiment/experiment.h"

namespace supercircle::experiment {

/// Ratios to the units of the reference, a shell of 19.2 mm radius and 0.62 N that is pressed for 26 s: the factors of
/// lengths, times and forces that were chosen for it. A set-up without specimens has ratios of 1.
struct NaturalUnits {
    double length = 1.0;   ///< radius of the specimen, at most four times the travel of the drive
    double time = 1.0;     ///< bending period R^2 sqrt(lambda/B), at most 1/2000 of the shortest run
    double settling = 1.0; ///< bending period alone
    double force = 1.0;    ///< B / R^2

    /// Factor of an amount in a unit of the files, "N s/m^2" or "1/(N m)"; 1 for angles and plain numbers.
    [[nodiscard]] double of(const std::string& unit) const;
};

NaturalUnits unitsOfSpecimens(const Experiment& experiment);

/// Radius of the unloaded specimen, m; of a nearly straight one its length over pi.
double radiusOf(const Specimen& specimen);

} // namespace supercircle::experiment
