#include "plugin/bench/bench_welded_boxes.h"

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/theme.h"
#include "supercircle/contact/crossing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::cli {

namespace {

namespace theme = graphics::theme;

constexpr double kPanel = 330.0; ///< px, width of one box
constexpr double kTall = 430.0;  ///< px
constexpr double kInner = 10.4;  ///< m

struct SheetView {
    double left, bottom, scale;
    [[nodiscard]] graphics::Point at(const Vec2& p) const {
        return {left + scale * (p.x() + 0.5 * kInner), bottom - scale * p.y()};
    }
};

void drawShells(graphics::Canvas& canvas, const SheetView& view, const GameRun& run) {
    const double width = view.scale * 2.0 * (run.curves.empty() ? 0.01 : run.curves.front().halfThickness);
    for (std::size_t i = 0; i < run.curves.size(); ++i) {
        std::vector<graphics::Point> points;
        for (const rod::Arc& arc : run.curves[i].arcs)
            for (int k = points.empty() ? 0 : 1; k <= 8; ++k)
                points.push_back(view.at(arc.pointAt(arc.length * k / 8.0)));
        const double hue = static_cast<double>((i * 7) % 30) / 30.0;
        const graphics::Colour colour{0.15 + 0.45 * hue, 0.35 + 0.2 * (1.0 - hue), 0.75 - 0.35 * hue};
        canvas.path(points, false, {.stroke = graphics::Stroke{colour, std::max(1.2, width)}});
    }
}

/// A red ring wherever two centre lines cross.
void markCrossings(graphics::Canvas& canvas, const SheetView& view, const GameRun& run) {
    std::vector<contact::Crossing> found;
    contact::findCrossings(run.curves, {}, found);
    for (const contact::Crossing& c : found)
        canvas.circle(view.at(c.where), 5.0, {.stroke = graphics::Stroke{theme::loading, 1.6}});
}

void drawPanel(graphics::Canvas& canvas, double x, const GameRun& run, const char* title) {
    const SheetView view{x, 80.0 + kTall, kPanel / kInner};
    const graphics::Rect area{x - 4.0, 80.0, kPanel + 8.0, kTall + 4.0};
    canvas.text({x, 50.0}, title, {theme::labelSize, theme::ink, graphics::Anchor::Start, true});
    char text[160];
    std::snprintf(text, sizeof text, "%.3f s CPU per s, stretch %.0e, %d pairs crossed", run.cpu, run.stretch,
                  run.crossings);
    canvas.text({x, 68.0}, text, {theme::tickSize, theme::muted});
    canvas.pushClip(area);
    drawShells(canvas, view, run);
    markCrossings(canvas, view, run);
    canvas.popClip();
    const graphics::Point a{x - 2.0, 80.0}, b{x - 2.0, 82.0 + kTall}, c{x + kPanel + 2.0, 82.0 + kTall},
        d{x + kPanel + 2.0, 80.0};
    canvas.path({a, b, c, d}, false, {.stroke = graphics::Stroke{theme::axis, 3.0}});
}

} // namespace

std::string weldedBoxesPicture(const GameRun& ours, const GameRun& boxes, const GameRun& tuned, std::string& error) {
    graphics::CairoCanvas canvas(3.0 * kPanel + 4.0 * 30.0, 80.0 + kTall + 30.0, 1.2);
    canvas.text({30.0, 26.0}, "Thirty shells of radius 1 m, five seconds at 1/60 s",
                {theme::titleSize, theme::ink, graphics::Anchor::Start, true});
    drawPanel(canvas, 30.0, ours, "Supercircle, game quality");
    drawPanel(canvas, 60.0 + kPanel, boxes, "15 welded boxes, 8/3 iterations, 1 substep");
    drawPanel(canvas, 90.0 + 2.0 * kPanel, tuned, "15 welded boxes, 64 substeps");
    auto png = canvas.png();
    error = png.error();
    return png ? *png : std::string();
}

} // namespace supercircle::cli
