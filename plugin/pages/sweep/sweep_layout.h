#pragma once
// How the sets of a sweep are laid out in pictures: along the abscissa, and in groups of all else that varies.

#include "plugin/graphics/canvas.h"
#include "plugin/lab/sweep/definition.h"

#include <string>
#include <vector>

namespace supercircle::cli {

struct SweepGroup {
    std::string label; ///< "μ = 0.35", what differs from the first of many; empty if nothing else varies
    report::Colour colour;
    std::vector<double> x;         ///< ascending
    std::vector<std::size_t> sets; ///< beside x
};

/// In the order in which groups appear in the sweep. What varies with the abscissa alone makes no group.
std::vector<SweepGroup> groupsOf(const sweep::Definition& sweep);

/// "Φ / 2π" for phi_bar, "μ" for mu, words for the rest.
std::string parameterLabel(const std::string& name);
/// Words and unit of a number of the summary.
std::string quantityLabel(const std::string& key);
/// "%.4g"
std::string shortNumber(double value, const char* format = "%.4g");

} // namespace supercircle::cli
