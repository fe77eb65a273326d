#pragma once
// Draws the diagrams of a comparison.

#include "plugin/graphics/canvas.h"
#include "plugin/lab/validation/experiment.h"

namespace supercircle::pages {

/// Size of the figure of an experiment: its diagrams in two columns.
struct FigureSize {
    double width = 0.0, height = 0.0;
};
FigureSize figureSize(const validation::ValidationExperiment& e);

/// All diagrams of an experiment.
void drawFigure(graphics::Canvas& canvas, const validation::ValidationExperiment& e);

} // namespace supercircle::pages
