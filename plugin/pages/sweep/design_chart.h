#pragma once
// The chart of `supercircle design`.

#include "plugin/lab/sweep/design.h"
#include "plugin/pages/sweep/sweep_figures.h"

namespace supercircle::pages {

/// The response surface as colours over its two parameters, the contour of the target value, thin contours at one
/// standard error, dots at the points of the sweep. With one parameter: the curve, its error and the target level.
SweepFigure designChart(const sweep::ResponseSurface& surface, const std::string& quantity, double target);

} // namespace supercircle::pages
