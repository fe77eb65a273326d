#pragma once
// The effects that are concealed, by family: in which experiments they can show, and how large "one" is.

#include "tests/blind_benchmark/conceal/draw.h"
#include "tests/reference_simulator/effects.h"

#include <functional>
#include <string>
#include <vector>

namespace supercircle::oracle {

enum class Protocol { Cylinder, Shells, Strip, Arch };

struct Family {
    std::string name, label; ///< label as in docs/effects.md; families may share one
    std::vector<Protocol> protocols;
    bool markers = false;    ///< shows in shapes: markers are always tracked
    double largest = 5.0;    ///< amplitude, in units of one
    bool known = true;       ///< in the catalogue of the diagnosis
    bool weightless = false; ///< the description declares no gravity
    /// Details are drawn once; the result makes the effect at any amplitude.
    std::function<std::function<Hidden(double amplitude)>(Draw&, Protocol)> draw;
};

const std::vector<Family>& families();
/// Throws std::invalid_argument for a name that is not known.
const Family& family(const std::string& name);
/// Labels that no reading of these experiments tells from the given one, whatever is measured: other names of the same
/// deflection or of the same weak place. Who takes an effect out of the catalogue takes them out too, or the right
/// answer is one of them.
std::vector<std::string> twins(const std::string& label);

} // namespace supercircle::oracle
