#include "plugin/pages/diagnosis/diagnose_figures.h"

#include "plugin/graphics/plot.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/graphics/theme.h"

#include <algorithm>
#include <cmath>

namespace supercircle::cli {

namespace theme = graphics::theme;

std::string learnedFigure(const diagnosis::Diagnosis& d, std::size_t law) {
    const diagnosis::LearnedLaw& l = d.learned[law];
    const bool share = l.responseUnit == "1", small = l.stateUnit == "m" || l.stateUnit == "m/s";
    const double fx = small ? 1e3 : 1.0, fy = share ? 100.0 : 1.0;
    std::vector<double> x, y;
    graphics::AxisRange range{0.0, 0.0};
    for (std::size_t i = 0; i < l.states.size(); ++i) {
        x.push_back(l.logarithmic ? std::log10(fx * l.states[i]) : fx * l.states[i]);
        y.push_back(l.inStateRange[i] ? fy * l.value[i] : std::nan(""));
        if (l.inStateRange[i])
            range = {std::min(range.lo, fy * (l.value[i] - 2.0 * l.sigma[i])),
                     std::max(range.hi, fy * (l.value[i] + 2.0 * l.sigma[i]))};
    }
    if (range.span() <= 0.0)
        return {};
    graphics::SvgCanvas canvas(640.0, 300.0, l.label, l.response + " against " + l.state);
    const graphics::Plot plot({90.0, 16.0, 520.0, 220.0}, {x.front(), x.back()}, graphics::padded(range, 0.05));
    graphics::PlotStyle style;
    const std::string unit = small ? (l.stateUnit == "m" ? "mm" : "mm/s") : l.stateUnit;
    style.x = {(l.logarithmic ? "log10 of " : "") + l.state + " (" + unit + ")", 1.0};
    style.y = {"change of " + l.response + (share ? " (%)" : " (" + l.responseUnit + ")"), 1.0};
    plot.drawFrame(canvas, style);
    for (const double deviations : {2.0, 1.0}) {
        std::vector<graphics::Point> band, back;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (l.inStateRange[i]) {
                band.push_back(plot.at(x[i], fy * (l.value[i] + deviations * l.sigma[i])));
                back.push_back(plot.at(x[i], fy * (l.value[i] - deviations * l.sigma[i])));
            }
        band.insert(band.end(), back.rbegin(), back.rend());
        canvas.path(band, true, {.fill = theme::unloading.alpha(0.2)});
    }
    plot.drawLine(canvas, x, y, {theme::unloading, 2.0});
    return canvas.finish();
}

} // namespace supercircle::cli
