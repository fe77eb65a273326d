#pragma once
// Pictures of a sweep: numbers against a parameter, histograms, force curves, cycles. Each is one drawing that goes
// into the page (SVG) and into a PNG file.

#include "plugin/graphics/canvas.h"
#include "plugin/lab/sweep/table.h"

#include <functional>
#include <string>
#include <vector>

namespace supercircle::cli {

/// A drawing that is not yet drawn.
struct SweepFigure {
    std::string name;    ///< of the PNG file, without its ending
    std::string title;   ///< for people
    std::string caption; ///< what is shown
    double width = 0.0, height = 0.0;
    std::function<void(report::Canvas&)> draw;
};

/// Numbers of the summary worth a picture: in `table`, known to matter, and not the same for all runs.
std::vector<std::string> headlines(const sweep::Table& table);

/// One number against the sweep's abscissa, a curve per group: mean, its standard error, and the spread of single runs
/// (1.4826 MAD). `only`: label of the one group to be shown, empty: all.
SweepFigure trendFigure(const sweep::Definition& sweep, const sweep::Table& table, const std::string& quantity,
                        const std::string& only = {});
/// Histograms of a number, one panel per set, with the Gaussian of mean and MAD and the p value of a normality test.
SweepFigure histogramFigure(const sweep::Definition& sweep, const sweep::Table& table, const std::string& quantity);
/// Force against displacement, one panel per set: some runs thin, the first one bold. `curves`: by set.
SweepFigure forceFigure(const sweep::Definition& sweep, const std::vector<std::vector<sweep::RunResult>>& curves);
/// Means of the cycles' numbers against the number of the cycle, a curve per set; nothing to draw below two cycles.
SweepFigure cyclesFigure(const sweep::Definition& sweep, const sweep::Table& table);

} // namespace supercircle::cli
