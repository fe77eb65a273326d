#include "plugin/pages/sweep/design_chart.h"

#include "plugin/graphics/colour_map.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"
#include "plugin/pages/sweep/sweep_layout.h"

#include <algorithm>
#include <cmath>

namespace supercircle::pages {

namespace {

using graphics::Anchor;
using graphics::AxisRange;
using graphics::Canvas;
using graphics::Plot;
using graphics::PlotStyle;
using graphics::Point;
using sweep::ResponseSurface;
namespace theme = graphics::theme;

constexpr int kColumns = 110, kRows = 80;

/// Ordinate of the chart: logarithmic where the interpolation is.
bool logarithmic(const ResponseSurface& s) {
    return s.y.size() > 1 && s.y.front() > 0.0;
}
double shown(const ResponseSurface& s, double y) {
    return logarithmic(s) ? std::log10(y) : y;
}
double dataOf(const ResponseSurface& s, double v) {
    return logarithmic(s) ? std::pow(10.0, v) : v;
}

AxisRange rangeOf(const ResponseSurface& s) {
    AxisRange range{s.mean.front().front(), s.mean.front().front()};
    for (const auto& row : s.mean)
        for (const double v : row)
            range = {std::min(range.lo, v), std::max(range.hi, v)};
    return range;
}

/// Contour of mean + shift * error by marching squares on a fine grid.
void drawContour(Canvas& canvas, const Plot& plot, const ResponseSurface& s, double target, double shift,
                 const graphics::Stroke& stroke) {
    const auto value = [&](int i, int k) {
        const ResponseSurface::Value v =
            s.at(plot.x.lo + plot.x.span() * i / kColumns, dataOf(s, plot.y.lo + plot.y.span() * k / kRows));
        return v.mean + shift * v.error - target;
    };
    const auto place = [&](double i, double k) {
        return plot.at(plot.x.lo + plot.x.span() * i / kColumns, plot.y.lo + plot.y.span() * k / kRows);
    };
    for (int k = 0; k < kRows; ++k)
        for (int i = 0; i < kColumns; ++i) {
            const double v[4] = {value(i, k), value(i + 1, k), value(i + 1, k + 1), value(i, k + 1)};
            const double at[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
            std::vector<Point> cuts;
            for (int e = 0; e < 4; ++e) {
                const double a = v[e], b = v[(e + 1) % 4];
                if ((a < 0.0) == (b < 0.0))
                    continue;
                const double t = a / (a - b);
                cuts.push_back(
                    place(i + at[e][0] + t * (at[e + 1][0] - at[e][0]), k + at[e][1] + t * (at[e + 1][1] - at[e][1])));
            }
            for (std::size_t c = 0; c + 1 < cuts.size(); c += 2)
                canvas.line(cuts[c], cuts[c + 1], stroke);
        }
}

void drawOrdinate(Canvas& canvas, const Plot& plot, const ResponseSurface& s) {
    for (const double y : s.y) {
        const double py = plot.at(plot.x.lo, shown(s, y)).y;
        canvas.line({plot.area.x - 4.0, py}, {plot.area.x, py}, {theme::axis, 1.0});
        canvas.text({plot.area.x - 8.0, py + 4.0}, shortNumber(y), {theme::tickSize, theme::muted, Anchor::End});
    }
    canvas.text({plot.area.x - 52.0, plot.area.y + 0.5 * plot.area.height}, parameterLabel(s.yName),
                {theme::labelSize, theme::ink, Anchor::Middle, false, -90.0});
}

void drawScale(Canvas& canvas, const graphics::Rect& bar, const AxisRange& range, const std::string& label) {
    for (int i = 0; i < 100; ++i)
        canvas.rectangle({bar.x, bar.bottom() - bar.height * (i + 1) / 100.0, bar.width, bar.height / 100.0 + 0.5},
                         {.fill = graphics::energyColour(0.85 * i / 99.0)});
    const graphics::Ticks ticks = graphics::niceTicks(range, 6);
    for (const double v : ticks.values)
        canvas.text({bar.right() + 6.0, bar.bottom() - bar.height * (v - range.lo) / range.span() + 4.0},
                    ticks.label(v), {theme::tickSize, theme::muted});
    canvas.text({bar.right() + 50.0, bar.y + 0.5 * bar.height}, label,
                {theme::labelSize, theme::ink, Anchor::Middle, false, 90.0});
}

void drawPlane(Canvas& canvas, const ResponseSurface& s, const std::string& quantity, double target) {
    const AxisRange range = rangeOf(s);
    const Plot plot({80.0, 30.0, 560.0, 400.0}, {s.x.front(), s.x.back()},
                    {shown(s, s.y.front()), shown(s, s.y.back())});
    const double width = plot.area.width / kColumns, height = plot.area.height / kRows;
    for (int k = 0; k < kRows; ++k)
        for (int i = 0; i < kColumns; ++i) {
            const double v = s.at(plot.x.lo + plot.x.span() * (i + 0.5) / kColumns,
                                  dataOf(s, plot.y.lo + plot.y.span() * (k + 0.5) / kRows))
                                 .mean;
            canvas.rectangle(
                {plot.area.x + width * i, plot.area.bottom() - height * (k + 1), width + 0.4, height + 0.4},
                {.fill = graphics::energyColour(0.85 * (v - range.lo) / std::max(range.span(), 1e-300))});
        }
    canvas.rectangle(plot.area, {.stroke = graphics::Stroke{theme::axis, 1.0}});
    for (const double x : s.x) {
        const double px = plot.at(x, plot.y.lo).x;
        canvas.text({px, plot.area.bottom() + 18.0}, shortNumber(x), {theme::tickSize, theme::muted, Anchor::Middle});
        for (const double y : s.y)
            canvas.circle(plot.at(x, shown(s, y)), 3.0,
                          {.fill = theme::paper, .stroke = graphics::Stroke{theme::ink, 1.0}});
    }
    canvas.text({plot.area.x + 0.5 * plot.area.width, plot.area.bottom() + 42.0}, parameterLabel(s.xName),
                {theme::labelSize, theme::ink, Anchor::Middle});
    drawOrdinate(canvas, plot, s);
    canvas.pushClip(plot.area);
    for (const double shift : {-1.0, 1.0})
        drawContour(canvas, plot, s, target, shift, {theme::paper, 1.4});
    drawContour(canvas, plot, s, target, 0.0, {theme::ink, 3.0});
    canvas.popClip();
    drawScale(canvas, {668.0, 30.0, 18.0, 400.0}, range, quantityLabel(quantity));
}

void drawLine(Canvas& canvas, const ResponseSurface& s, const std::string& quantity, double target) {
    AxisRange range = rangeOf(s);
    for (std::size_t k = 0; k < s.x.size(); ++k)
        range = {std::min(range.lo, s.mean[0][k] - s.spread[0][k]), std::max(range.hi, s.mean[0][k] + s.spread[0][k])};
    range = graphics::padded({std::min(range.lo, target), std::max(range.hi, target)}, 0.06);
    const Plot plot({80.0, 30.0, 560.0, 400.0}, graphics::padded({s.x.front(), s.x.back()}, 0.04), range);
    PlotStyle style;
    style.x = {parameterLabel(s.xName), 1.0};
    style.y = {quantityLabel(quantity), 1.0};
    plot.drawFrame(canvas, style);
    std::vector<Point> upper, lower;
    for (std::size_t k = 0; k < s.x.size(); ++k) {
        upper.push_back(plot.at(s.x[k], s.mean[0][k] + s.error[0][k]));
        lower.push_back(plot.at(s.x[k], s.mean[0][k] - s.error[0][k]));
    }
    upper.insert(upper.end(), lower.rbegin(), lower.rend());
    canvas.path(upper, true, {.fill = theme::unloading.alpha(0.25)});
    plot.drawLine(canvas, s.x, s.mean[0], {theme::unloading, 2.0});
    const double y = plot.at(0.0, target).y;
    canvas.line({plot.area.x, y}, {plot.area.right(), y}, {theme::ink, 1.6, {6.0, 4.0}});
}

} // namespace

SweepFigure designChart(const ResponseSurface& surface, const std::string& quantity, double target) {
    SweepFigure figure;
    figure.name = "design_" + quantity;
    figure.title = quantityLabel(quantity) + " = " + shortNumber(target);
    figure.caption = surface.y.size() > 1
                         ? "Colours: mean of the runs, interpolated between the dots, the points "
                           "of the sweep. Line: the target value; thin: plus and minus one standard error."
                         : "Mean of the runs with its standard error; dashed: the target value.";
    figure.width = 780.0;
    figure.height = 490.0;
    figure.draw = [surface, quantity, target](Canvas& canvas) {
        if (surface.y.size() > 1)
            drawPlane(canvas, surface, quantity, target);
        else
            drawLine(canvas, surface, quantity, target);
    };
    return figure;
}

} // namespace supercircle::pages
