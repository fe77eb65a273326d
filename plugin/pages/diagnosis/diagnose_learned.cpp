#include "plugin/pages/diagnosis/diagnose_figures.h"

#include "plugin/graphics/plot.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/graphics/theme.h"

#include <algorithm>
#include <cmath>

namespace supercircle::cli {

namespace theme = report::theme;

std::string learnedFigure(const diagnosis::Diagnosis& d, std::size_t law) {
    const diagnosis::LearnedLaw& l = d.learned[law];
    const bool share = l.ofUnit == "1", small = l.overUnit == "m" || l.overUnit == "m/s";
    const double fx = small ? 1e3 : 1.0, fy = share ? 100.0 : 1.0;
    std::vector<double> x, y;
    report::Range range{0.0, 0.0};
    for (std::size_t i = 0; i < l.at.size(); ++i) {
        x.push_back(l.logarithmic ? std::log10(fx * l.at[i]) : fx * l.at[i]);
        y.push_back(l.visited[i] ? fy * l.value[i] : std::nan(""));
        if (l.visited[i])
            range = {std::min(range.lo, fy * (l.value[i] - 2.0 * l.deviation[i])),
                     std::max(range.hi, fy * (l.value[i] + 2.0 * l.deviation[i]))};
    }
    if (range.span() <= 0.0)
        return {};
    report::SvgCanvas canvas(640.0, 300.0, l.label, l.of + " against " + l.over);
    const report::Plot plot({90.0, 16.0, 520.0, 220.0}, {x.front(), x.back()}, report::padded(range, 0.05));
    report::PlotStyle style;
    const std::string unit = small ? (l.overUnit == "m" ? "mm" : "mm/s") : l.overUnit;
    style.x = {(l.logarithmic ? "log10 of " : "") + l.over + " (" + unit + ")", 1.0};
    style.y = {"change of " + l.of + (share ? " (%)" : " (" + l.ofUnit + ")"), 1.0};
    plot.drawFrame(canvas, style);
    for (const double deviations : {2.0, 1.0}) {
        std::vector<report::Point> band, back;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (l.visited[i]) {
                band.push_back(plot.at(x[i], fy * (l.value[i] + deviations * l.deviation[i])));
                back.push_back(plot.at(x[i], fy * (l.value[i] - deviations * l.deviation[i])));
            }
        band.insert(band.end(), back.rbegin(), back.rend());
        canvas.path(band, true, {.fill = theme::unloading.alpha(0.2)});
    }
    plot.drawLine(canvas, x, y, {theme::unloading, 2.0});
    return canvas.finish();
}

} // namespace supercircle::cli
