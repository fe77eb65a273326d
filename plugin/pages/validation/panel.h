#pragma once
// Draws the diagrams of a comparison.

#include "plugin/graphics/canvas.h"
#include "plugin/lab/validation/experiment.h"

namespace supercircle::validation {

/// Size of the figure of an experiment: its panels in two columns.
struct FigureSize {
    double width = 0.0, height = 0.0;
};
FigureSize figureSize(const Experiment& e);

/// All panels of an experiment.
void drawFigure(report::Canvas& canvas, const Experiment& e);

} // namespace supercircle::validation
