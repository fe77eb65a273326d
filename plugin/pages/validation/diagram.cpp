#include "plugin/pages/validation/diagram.h"

#include "plugin/graphics/axis.h"
#include "plugin/graphics/theme.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supercircle::pages {

using validation::Diagram;
using validation::PlotLine;
using validation::ValidationExperiment;

namespace {

using graphics::Anchor;
using graphics::Canvas;
using graphics::Colour;
using graphics::Rect;
namespace theme = graphics::theme;

constexpr double kDiagramWidth = 620.0, kDiagramHeight = 470.0;
constexpr double kLegendRow = 18.0, kLegendSize = 12.0;

/// Distinct for colour-blind readers (Okabe and Ito).
Colour colourOf(int index) {
    static constexpr std::array<unsigned, 7> palette{0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7,
                                                     0xa17800, 0x3a9bd6, 0x444444};
    return Colour::hex(palette[static_cast<std::size_t>(index) % palette.size()]);
}

/// One axis: data to pixels, and its ticks.
struct AxisScale {
    bool logarithmic = false;
    double lo = 0.0, hi = 1.0;   ///< of the data, or of their decimal logarithms
    double from = 0.0, to = 1.0; ///< px

    [[nodiscard]] double value(double v) const { return logarithmic ? std::log10(v) : v; }
    [[nodiscard]] double pixel(double v) const { return from + (value(v) - lo) / (hi - lo) * (to - from); }
};

struct Tick {
    double value = 0.0;
    std::string label;
};

std::vector<Tick> ticksOf(const AxisScale& s, int most, const std::vector<double>& wanted) {
    std::vector<Tick> out;
    if (!s.logarithmic) {
        const graphics::Ticks ticks = graphics::niceTicks({s.lo, s.hi}, most);
        for (const double v : ticks.values)
            out.push_back({v, ticks.label(v)});
        return out;
    }
    for (const double v : wanted)
        out.push_back({v, graphics::trimmed(v)});
    if (!out.empty())
        return out;
    const bool few = s.hi - s.lo > 3.0, many = s.hi - s.lo < 1.0;
    for (int decade = static_cast<int>(std::floor(s.lo)); decade <= static_cast<int>(std::ceil(s.hi)); ++decade)
        for (const double digit : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0}) {
            const double v = digit * std::pow(10.0, decade);
            const bool usual = digit == 1.0 || digit == 2.0 || digit == 5.0;
            if ((digit == 1.0 || !few) && (usual || many) && std::log10(v) >= s.lo - 1e-9 &&
                std::log10(v) <= s.hi + 1e-9)
                out.push_back({v, graphics::trimmed(v, 3)});
        }
    return out;
}

/// Whether a point can be drawn on the diagram's axes.
bool shown(const Diagram& p, double x, double y) {
    return std::isfinite(x) && std::isfinite(y) && (!p.logX || x > 0.0) && (!p.logY || y > 0.0);
}

void fit(const Diagram& p, AxisScale& x, AxisScale& y) {
    const double huge = std::numeric_limits<double>::infinity();
    x.lo = y.lo = huge;
    x.hi = y.hi = -huge;
    const auto take = [](AxisScale& s, double v) {
        s.lo = std::min(s.lo, s.value(v));
        s.hi = std::max(s.hi, s.value(v));
    };
    for (const PlotLine& line : p.lines)
        for (std::size_t i = 0; i < line.x.size(); ++i)
            if (shown(p, line.x[i], line.y[i])) {
                take(x, line.x[i]);
                take(y, line.y[i]);
            }
    if (p.target)
        take(y, *p.target);
    for (AxisScale* s : {&x, &y}) {
        const graphics::AxisRange padded = graphics::padded({s->lo, s->hi}, 0.05);
        s->lo = padded.lo;
        s->hi = padded.hi;
    }
}

/// Abscissae of a convergence study, used as ticks.
std::vector<double> abscissae(const Diagram& p) {
    std::vector<double> out;
    if (p.logX)
        for (const PlotLine& line : p.lines)
            if (line.style == PlotLine::Style::Connected)
                out.insert(out.end(), line.x.begin(), line.x.end());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end(), [](double a, double b) { return b < 1.12 * a; }), out.end());
    return out;
}

void drawFrame(Canvas& canvas, const Diagram& p, const Rect& area, const AxisScale& x, const AxisScale& y) {
    for (const Tick& t : ticksOf(x, 8, abscissae(p))) {
        const double px = x.pixel(t.value);
        canvas.line({px, area.y}, {px, area.bottom()}, {theme::grid, 1.0});
        canvas.text({px, area.bottom() + 18.0}, t.label, {theme::tickSize, theme::muted, Anchor::Middle});
    }
    for (const Tick& t : ticksOf(y, 7, {})) {
        const double py = y.pixel(t.value);
        canvas.line({area.x, py}, {area.right(), py}, {theme::grid, 1.0});
        canvas.text({area.x - 8.0, py + 4.0}, t.label, {theme::tickSize, theme::muted, Anchor::End});
    }
    if (!y.logarithmic && y.lo < 0.0 && y.hi > 0.0)
        canvas.line({area.x, y.pixel(0.0)}, {area.right(), y.pixel(0.0)}, {theme::axis, 1.2});
    canvas.rectangle(area, {.stroke = graphics::Stroke{theme::axis, 1.0}});
    canvas.text({area.x + 0.5 * area.width, area.bottom() + 40.0}, p.xLabel,
                {theme::labelSize, theme::ink, Anchor::Middle});
    canvas.text({area.x - 54.0, area.y + 0.5 * area.height}, p.yLabel,
                {theme::labelSize, theme::ink, Anchor::Middle, false, -90.0});
}

void marker(Canvas& canvas, graphics::Point at, int colour) {
    const graphics::Paint paint{.fill = theme::paper, .stroke = graphics::Stroke{colourOf(colour), 1.7}};
    if (colour % 3 == 0)
        canvas.circle(at, 3.6, paint);
    else if (colour % 3 == 1)
        canvas.rectangle({at.x - 3.2, at.y - 3.2, 6.4, 6.4}, paint);
    else
        canvas.path({{at.x, at.y - 4.6}, {at.x + 4.4, at.y + 3.4}, {at.x - 4.4, at.y + 3.4}}, true, paint);
}

void drawLine(Canvas& canvas, const Diagram& p, const PlotLine& line, const AxisScale& x, const AxisScale& y) {
    std::vector<graphics::Point> points;
    const auto flush = [&] {
        using Style = PlotLine::Style;
        if (line.style != Style::Points && points.size() > 1)
            canvas.path(points, false,
                        {.stroke = graphics::Stroke{colourOf(line.colour), line.style == Style::Reference ? 1.8 : 1.3,
                                                    line.style == Style::Dashed ? std::vector<double>{6.0, 4.0}
                                                                                : std::vector<double>{}}});
        if (line.style == Style::Points || line.style == Style::Connected)
            for (const graphics::Point& at : points)
                marker(canvas, at, line.colour);
        points.clear();
    };
    for (std::size_t i = 0; i < line.x.size(); ++i) {
        if (!shown(p, line.x[i], line.y[i])) {
            flush();
            continue;
        }
        points.push_back({x.pixel(line.x[i]), y.pixel(line.y[i])});
    }
    flush();
}

/// A row of samples and names above the diagram; returns its height.
double drawLegend(Canvas* canvas, const Diagram& p, const Rect& sheet, double top) {
    double x = sheet.x + 76.0, y = top;
    const auto entry = [&](const std::string& name, const auto& sample) {
        const double width = 30.0 + graphics::textWidth(name, kLegendSize) + 16.0;
        if (x + width > sheet.right() && x > sheet.x + 80.0) {
            x = sheet.x + 76.0;
            y += kLegendRow;
        }
        if (canvas != nullptr) {
            sample(graphics::Point{x, y + 8.0});
            canvas->text({x + 30.0, y + 12.0}, name, {kLegendSize, theme::ink});
        }
        x += width;
    };
    for (const PlotLine& line : p.lines)
        if (!line.name.empty())
            entry(line.name, [&](graphics::Point at) {
                if (line.style != PlotLine::Style::Points)
                    canvas->line(at, {at.x + 24.0, at.y},
                                 {colourOf(line.colour), 1.8,
                                  line.style == PlotLine::Style::Dashed ? std::vector<double>{6.0, 4.0}
                                                                        : std::vector<double>{}});
                if (line.style != PlotLine::Style::Reference && line.style != PlotLine::Style::Dashed)
                    marker(*canvas, {at.x + 12.0, at.y}, line.colour);
            });
    if (p.target)
        entry("target: " + graphics::trimmed(*p.target, 3) + " %", [&](graphics::Point at) {
            canvas->line(at, {at.x + 24.0, at.y}, {theme::loading, 1.4, {2.0, 4.0}});
        });
    return y + kLegendRow - top;
}

void drawDiagram(Canvas& canvas, const Diagram& p, const Rect& sheet) {
    canvas.text({sheet.x + 16.0, sheet.y + 22.0}, p.title, {14.5, theme::ink, Anchor::Start, true});
    const double legend = drawLegend(&canvas, p, sheet, sheet.y + 32.0);
    const double top = sheet.y + 32.0 + legend + 8.0;
    const Rect area{sheet.x + 76.0, top, sheet.width - 76.0 - 22.0, sheet.bottom() - 54.0 - top};
    AxisScale x{p.logX, 0.0, 1.0, area.x, area.right()}, y{p.logY, 0.0, 1.0, area.bottom(), area.y};
    fit(p, x, y);
    drawFrame(canvas, p, area, x, y);
    canvas.pushClip(area);
    if (p.target)
        canvas.line({area.x, y.pixel(*p.target)}, {area.right(), y.pixel(*p.target)},
                    {theme::loading, 1.4, {2.0, 4.0}});
    for (const PlotLine& line : p.lines)
        drawLine(canvas, p, line, x, y);
    canvas.popClip();
}

} // namespace

FigureSize figureSize(const ValidationExperiment& e) {
    const double columns = e.diagrams.size() > 1 ? 2.0 : 1.0;
    return {columns * kDiagramWidth, std::ceil(static_cast<double>(e.diagrams.size()) / columns) * kDiagramHeight};
}

void drawFigure(Canvas& canvas, const ValidationExperiment& e) {
    const std::size_t columns = e.diagrams.size() > 1 ? 2 : 1;
    for (std::size_t i = 0; i < e.diagrams.size(); ++i)
        drawDiagram(canvas, e.diagrams[i],
                    {kDiagramWidth * static_cast<double>(i % columns),
                     kDiagramHeight * static_cast<double>(i / columns), kDiagramWidth, kDiagramHeight});
}

} // namespace supercircle::pages
