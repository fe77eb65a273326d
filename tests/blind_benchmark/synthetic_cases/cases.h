#pragma once
// Sets of cases, and what is drawn for each case.

#include "tests/blind_benchmark/synthetic_cases/effect_families.h"
#include "tests/reference_simulator/description.h"

#include <string>
#include <vector>

namespace supercircle::blind_benchmark {

struct CasePlan {
    std::string name, part; ///< "tuning", "blind" or "limit"
    std::string kind;       ///< "nothing", "single", "pair", "removed" (from the catalogue) or "outside" (never in it)
    std::string strength;   ///< "limit", "weak", "strong"; without an effect "" or "snaps"
    std::vector<std::string> families;
    std::uint64_t seed = 0;
};

inline bool isPart(const std::string& word) {
    return word == "tuning" || word == "blind" || word == "limit";
}
/// @param seed of the whole set
std::vector<CasePlan> casePlans(const std::string& part, std::uint64_t seed);

/// Draws a described experiment, without effects.
Description drawDescription(Random& draw, Protocol protocol, bool weightless, bool markers, bool snaps);
/// Adds a run of the same machine behind the others. @param rate of the readings, Hz
void addRun(Description& d, Drive drive, double rate, bool specimenReversed = false);
Offsets drawOffsets(Random& draw);

/// Noise of the sensors.
struct SensorNoise {
    double white = 0.0, correlated = 0.0, correlationTime = 0.25; ///< N, N, s
    double quantum = 0.0;                                         ///< of the converter, N; 0: continuous
    bool heavyTails = false;                                      ///< Student's t instead of normal
    double marker = 0.0;                                          ///< m
    [[nodiscard]] double total() const { return std::hypot(white, correlated); }
};
SensorNoise drawSensorNoise(Random& draw, const Description& d);

} // namespace supercircle::blind_benchmark
