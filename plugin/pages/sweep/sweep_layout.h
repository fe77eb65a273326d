#pragma once
// Layout of the sets of a sweep in pictures: along the abscissa, and in groups by the other parameters.

#include "plugin/graphics/canvas.h"
#include "plugin/lab/sweep/definition.h"

#include <string>
#include <vector>

namespace supercircle::pages {

struct SweepGroup {
    std::string label; ///< "μ = 0.35", what differs from the first group; empty if nothing else varies
    graphics::Colour colour;
    std::vector<double> x;         ///< ascending
    std::vector<std::size_t> sets; ///< beside x
};

/// In the order of the sweep. Parameters that vary with the abscissa only make no group.
std::vector<SweepGroup> groupsOf(const sweep::SweepDefinition& sweep);

/// "Φ / 2π" for phi_bar, "μ" for mu, the name with its unit for the others.
std::string parameterLabel(const std::string& name);
/// Label and unit of a summary quantity.
std::string quantityLabel(const std::string& key);
/// "%.4g"
std::string shortNumber(double value, const char* format = "%.4g");

} // namespace supercircle::pages
