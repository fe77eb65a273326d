#pragma once
// Which cases there are, and what is drawn for each.

#include "tests/blind_benchmark/conceal/families.h"
#include "tests/reference_simulator/description.h"

#include <string>
#include <vector>

namespace supercircle::oracle {

struct Plan {
    std::string name, part; ///< "tuning", "blind" or "limit"
    std::string kind;       ///< nothing, single, pair, removed (from the catalogue), outside (of it)
    std::string strength;   ///< limit, weak, strong
    std::vector<std::string> families;
    std::uint64_t seed = 0;
};

inline bool isPart(const std::string& word) {
    return word == "tuning" || word == "blind" || word == "limit";
}
/// @param seed of the whole set: what stands in the documentation is 1 for tuning, 2026 for blind
std::vector<Plan> plans(const std::string& part, std::uint64_t seed);

/// An experiment as it is described, before anything is hidden.
Description drawDescription(Draw& draw, Protocol protocol, bool weightless, bool markers, bool snaps);
/// One more run of the same machine, behind the others. @param rate of the readings, Hz @param turned RunPlan::turned
void addRun(Description& d, Drive drive, double rate, bool turned = false);
Offsets drawOffsets(Draw& draw);

/// How bad the sensors are.
struct Nuisance {
    double white = 0.0, coloured = 0.0, memory = 0.25; ///< N, N, s
    double step = 0.0;                                 ///< of the converter, N; 0: none
    bool heavy = false;                                ///< heavy tails
    double marker = 0.0;                               ///< m
    [[nodiscard]] double total() const { return std::hypot(white, coloured); }
};
Nuisance drawNuisance(Draw& draw, const Description& d);

} // namespace supercircle::oracle
