#include "plugin/bench/bench_scaling.h"

#include "plugin/graphics/axis.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/plot.h"
#include "plugin/graphics/theme.h"

#include <algorithm>
#include <cmath>

namespace supercircle::cli {

namespace {

namespace theme = graphics::theme;
using graphics::Colour;

constexpr Colour kDrop = Colour::hex(0x2a6fb8), kCycle = Colour::hex(0xc8452d), kStep = Colour::hex(0x3a8f5c);
constexpr Colour kSizes[] = {Colour::hex(0xe0a030), Colour::hex(0x3a8f5c), Colour::hex(0x2a6fb8), Colour::hex(0x8055a0),
                             Colour::hex(0xc8452d)};

std::string plain(double value) {
    char text[24];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

void decades(graphics::Canvas& canvas, const graphics::Plot& plot, bool binaryX) {
    for (double e = std::ceil(plot.x.lo); e <= plot.x.hi; e += 1.0) {
        const graphics::Point p = plot.at(e, plot.y.lo);
        canvas.line(p, {p.x, plot.area.y}, {theme::grid, 1.0});
        canvas.text({p.x, p.y + 18.0}, plain(std::pow(binaryX ? 2.0 : 10.0, e)),
                    {theme::tickSize, theme::muted, graphics::Anchor::Middle});
    }
    for (double e = std::ceil(plot.y.lo); e <= plot.y.hi; e += 1.0) {
        const graphics::Point p = plot.at(plot.x.lo, e);
        canvas.line(p, {plot.area.right(), p.y}, {theme::grid, 1.0});
        canvas.text({p.x - 8.0, p.y + 4.0}, plain(std::pow(binaryX ? 2.0 : 10.0, e)),
                    {theme::tickSize, theme::muted, graphics::Anchor::End});
    }
    canvas.rectangle(plot.area, {.stroke = graphics::Stroke{theme::axis, 1.0}});
}

void labels(graphics::Canvas& canvas, const graphics::Plot& plot, const std::string& x, const std::string& y) {
    canvas.text({plot.area.x + 0.5 * plot.area.width, plot.area.bottom() + 40.0}, x,
                {theme::labelSize, theme::ink, graphics::Anchor::Middle});
    canvas.text({plot.area.x - 52.0, plot.area.y + 0.5 * plot.area.height}, y,
                {theme::labelSize, theme::ink, graphics::Anchor::Middle, false, -90.0});
}

// Values of a row; 0 if the run ended earlier.
double dropTime(const ScalingRow& row) {
    return row.cycleCpu > 0.0 ? row.dropCpu : 0.0;
}

double cycleTime(const ScalingRow& row) {
    return row.complete ? row.cycleCpu : 0.0;
}

double solveTime(const ScalingRow& row) {
    return row.cycleCpu > 0.0 ? row.full.ms : 0.0;
}

/// Points with a line; hollow where the run was incomplete.
void series(graphics::Canvas& canvas, const graphics::Plot& plot, const std::vector<ScalingRow>& rows, Colour colour,
            double (*value)(const ScalingRow&)) {
    std::vector<graphics::Point> points;
    std::vector<bool> full;
    for (const ScalingRow& row : rows)
        if (const double y = value(row); y > 0.0) {
            points.push_back(plot.at(std::log10(row.shells), std::log10(y)));
            full.push_back(row.complete);
        }
    canvas.path(points, false, {.stroke = graphics::Stroke{colour, 1.8}});
    for (std::size_t i = 0; i < points.size(); ++i)
        canvas.circle(points[i], 4.0,
                      {.fill = full[i] ? colour : theme::paper, .stroke = graphics::Stroke{colour, 1.5}});
}

void slope(graphics::Canvas& canvas, const graphics::Plot& plot, double x, double y, double exponent,
           const std::string& name) {
    const double to = std::min(plot.x.hi - 0.1, x + (plot.y.hi - 0.15 - y) / exponent);
    const graphics::Point a = plot.at(x, y), b = plot.at(to, y + exponent * (to - x));
    canvas.pushClip(plot.area);
    canvas.line(a, b, {theme::muted, 1.0, {4.0, 4.0}});
    canvas.popClip();
    canvas.text({b.x - 4.0, b.y - 6.0}, name, {theme::tickSize, theme::muted, graphics::Anchor::End});
}

void legend(graphics::Canvas& canvas, const graphics::Plot& plot, double row, Colour colour, const std::string& text) {
    const double x = plot.area.x + 14.0, y = plot.area.y + 22.0 + 18.0 * row;
    canvas.line({x, y - 4.0}, {x + 20.0, y - 4.0}, {colour, 2.0});
    canvas.text({x + 28.0, y}, text, {theme::tickSize, theme::ink});
}

void drawCost(graphics::Canvas& canvas, const graphics::Plot& plot, const std::vector<ScalingRow>& rows) {
    decades(canvas, plot, false);
    labels(canvas, plot, "shells", "CPU time on one core / s");
    slope(canvas, plot, 1.5, plot.y.lo + 0.1, 1.0, "N");
    slope(canvas, plot, 1.5, plot.y.lo + 0.1, 2.0, "N squared");
    series(canvas, plot, rows, kDrop, dropTime);
    series(canvas, plot, rows, kCycle, cycleTime);
    series(canvas, plot, rows, kStep, solveTime);
    legend(canvas, plot, 0.0, kDrop, "drop");
    legend(canvas, plot, 1.0, kCycle, "one loading cycle");
    legend(canvas, plot, 2.0, kStep, "a thousand solves under full load");
}

void drawSpeedUp(graphics::Canvas& canvas, const graphics::Plot& plot, const std::vector<ScalingRow>& rows) {
    decades(canvas, plot, true);
    labels(canvas, plot, "threads", "speed-up of the cycle, computed");
    canvas.line(plot.at(0.0, 0.0), plot.at(plot.x.hi, plot.x.hi), {theme::muted, 1.0, {4.0, 4.0}});
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Colour colour = kSizes[k % std::size(kSizes)];
        std::vector<graphics::Point> points;
        for (std::size_t i = 0; i < VirtualThreads::kThreads.size(); ++i)
            if (const double gain = rows[k].speedUp(i); gain > 0.0)
                points.push_back(plot.at(std::log2(VirtualThreads::kThreads[i]), std::log2(gain)));
        canvas.path(points, false, {.stroke = graphics::Stroke{colour, 1.8}});
        for (const graphics::Point& p : points)
            canvas.circle(p, 3.5, {.fill = colour});
        legend(canvas, plot, static_cast<double>(k), colour,
               std::to_string(rows[k].shells) + " shells" + (rows[k].complete ? "" : ", incomplete"));
    }
}

} // namespace

std::string scalingPicture(const std::vector<ScalingRow>& rows, std::string& error) {
    constexpr double width = 430.0, height = 400.0, left = 84.0, top = 70.0;
    graphics::CairoCanvas canvas(2.0 * (left + width) + 30.0, top + height + 70.0, 2.0);
    canvas.text({left, 34.0}, "Stacks of many shells", {theme::titleSize, theme::ink, graphics::Anchor::Start, true});
    double least = 1e300, most = 0.0;
    for (const ScalingRow& row : rows)
        for (const double y : {dropTime(row), cycleTime(row), solveTime(row)})
            if (y > 0.0) {
                least = std::min(least, y);
                most = std::max(most, y);
            }
    const graphics::AxisRange x{0.9, 3.1}, y{std::log10(least) - 0.2, std::log10(most) + 0.9};
    drawCost(canvas, graphics::Plot({left, top, width, height}, x, y), rows);
    drawSpeedUp(canvas, graphics::Plot({2.0 * left + width, top, width, height}, {-0.2, 6.2}, {-0.2, 6.2}), rows);
    auto png = canvas.png();
    error = png.error();
    return png ? *png : std::string();
}

} // namespace supercircle::cli
