#pragma once
// Pictures of a sweep: quantities against a parameter, histograms, force curves, cycles. Each is one drawing for the
// page (SVG) and a PNG file.

#include "plugin/graphics/canvas.h"
#include "plugin/lab/sweep/run_table.h"

#include <functional>
#include <string>
#include <vector>

namespace supercircle::pages {

/// A picture and the function that draws it.
struct SweepFigure {
    std::string name;    ///< of the PNG file, without its ending
    std::string title;   ///< shown above the picture
    std::string caption; ///< what the picture shows
    double width = 0.0, height = 0.0;
    std::function<void(graphics::Canvas&)> draw;
};

/// Summary quantities with a picture: the main ones that are in `table` and not equal for all runs.
std::vector<std::string> mainQuantities(const sweep::RunTable& table);

/// One quantity against the sweep's abscissa, a curve per group: mean, its standard error, and the spread of single
/// runs (1.4826 MAD). `only`: label of the single group to be shown; empty: all.
SweepFigure trendFigure(const sweep::SweepDefinition& sweep, const sweep::RunTable& table, const std::string& quantity,
                        const std::string& only = {});
/// Histograms of a quantity, one panel per set, with the Gaussian of mean and MAD and the p value of a normality test.
SweepFigure histogramFigure(const sweep::SweepDefinition& sweep, const sweep::RunTable& table,
                            const std::string& quantity);
/// Force against displacement, one panel per set: some runs thin, the first one bold. `curves`: by set.
SweepFigure forceFigure(const sweep::SweepDefinition& sweep, const std::vector<std::vector<sweep::RunRecord>>& curves);
/// Means of the cycle quantities against the cycle number, a curve per set; no picture below two cycles.
SweepFigure cyclesFigure(const sweep::SweepDefinition& sweep, const sweep::RunTable& table);

} // namespace supercircle::pages
