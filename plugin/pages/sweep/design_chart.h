#pragma once
// The chart of `supercircle design`.

#include "plugin/lab/sweep/design.h"
#include "plugin/pages/sweep/sweep_figures.h"

namespace supercircle::cli {

/// The surface as colours over its two parameters, the line of the wanted value, thin the lines one standard error
/// aside, dots where the sweep was played. With one parameter: the curve, its error and the wanted level.
SweepFigure designChart(const sweep::Surface& surface, const std::string& quantity, double wanted);

} // namespace supercircle::cli
