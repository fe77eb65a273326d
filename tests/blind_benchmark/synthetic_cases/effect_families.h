#pragma once
// Families of hidden effects: set-ups in which they can be visible, and the unit of their amplitude.

#include "tests/blind_benchmark/synthetic_cases/random.h"
#include "tests/reference_simulator/effects.h"

#include <functional>
#include <string>
#include <vector>

namespace supercircle::blind_benchmark {

using namespace reference_simulator;

enum class Protocol { Cylinder, Shells, Strip, Arch };

struct Family {
    std::string name, label; ///< label of docs/reference/effects.md; families may share one
    std::vector<Protocol> protocols;
    bool markers = false;    ///< visible in shapes: markers are always tracked
    double largest = 5.0;    ///< largest amplitude, in units of the family
    bool known = true;       ///< the diagnosis has it in its catalogue
    bool weightless = false; ///< the description declares no gravity
    /// Draws the details once. The result gives the effect at any amplitude.
    std::function<std::function<HiddenEffect(double amplitude)>(Random&, Protocol)> draw;
};

const std::vector<Family>& families();
/// Throws std::invalid_argument for a name that is not known.
const Family& family(const std::string& name);
/// Labels that no reading of these set-ups can tell from the given one: other names of the same deflection or of the
/// same weak section. An effect is removed from the catalogue together with them, because they would be right answers.
std::vector<std::string> equivalentLabels(const std::string& label);

} // namespace supercircle::blind_benchmark
