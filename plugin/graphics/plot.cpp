#include "plugin/graphics/plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "plugin/graphics/decimate.h"
#include "plugin/graphics/theme.h"

namespace supercircle::graphics {

namespace {

AxisRange scaled(const AxisRange& range, double factor) {
    return {range.lo * factor, range.hi * factor};
}

TextStyle tickStyle(const PlotStyle& style, Anchor anchor) {
    return {theme::tickSize, style.muted, anchor};
}

} // namespace

void Plot::drawGrid(Canvas& canvas, const PlotStyle& style) const {
    const Ticks tx = niceTicks(scaled(x, style.x.factor), style.xTicks);
    const Ticks ty = niceTicks(scaled(y, style.y.factor), style.yTicks);
    for (const double value : tx.values) {
        const double px = at(value / style.x.factor, y.lo).x;
        canvas.line({px, area.y}, {px, area.bottom()}, {style.grid, 1.0});
        canvas.text({px, area.bottom() + 18.0}, tx.label(value), tickStyle(style, Anchor::Middle));
    }
    for (const double value : ty.values) {
        const double py = at(x.lo, value / style.y.factor).y;
        canvas.line({area.x, py}, {area.right(), py}, {style.grid, 1.0});
        canvas.text({area.x - 8.0, py + 4.0}, ty.label(value), tickStyle(style, Anchor::End));
    }
}

void Plot::drawSecondAxes(Canvas& canvas, const PlotStyle& style) const {
    if (style.top) {
        const Ticks ticks = niceTicks(scaled(x, style.top->factor), style.xTicks);
        for (const double value : ticks.values) {
            const double px = at(value / style.top->factor, y.lo).x;
            canvas.line({px, area.y}, {px, area.y - 4.0}, {style.axis, 1.0});
            canvas.text({px, area.y - 9.0}, ticks.label(value), tickStyle(style, Anchor::Middle));
        }
        canvas.text({area.x + 0.5 * area.width, area.y - 28.0}, style.top->label,
                    {theme::labelSize, style.muted, Anchor::Middle});
    }
    if (style.right) {
        const Ticks ticks = niceTicks(scaled(y, style.right->factor), style.yTicks);
        for (const double value : ticks.values) {
            const double py = at(x.lo, value / style.right->factor).y;
            canvas.line({area.right(), py}, {area.right() + 4.0, py}, {style.axis, 1.0});
            canvas.text({area.right() + 9.0, py + 4.0}, ticks.label(value), tickStyle(style, Anchor::Start));
        }
        canvas.text({area.right() + 54.0, area.y + 0.5 * area.height}, style.right->label,
                    {theme::labelSize, style.muted, Anchor::Middle, false, 90.0});
    }
}

void Plot::drawFrame(Canvas& canvas, const PlotStyle& style) const {
    drawGrid(canvas, style);
    if (y.lo < 0.0 && y.hi > 0.0) {
        const double zero = at(x.lo, 0.0).y;
        canvas.line({area.x, zero}, {area.right(), zero}, {style.axis, 1.2});
    }
    canvas.rectangle(area, {.stroke = Stroke{style.axis, 1.0}});
    if (!style.x.label.empty())
        canvas.text({area.x + 0.5 * area.width, area.bottom() + 40.0}, style.x.label,
                    {theme::labelSize, style.ink, Anchor::Middle});
    canvas.text({area.x - 52.0, area.y + 0.5 * area.height}, style.y.label,
                {theme::labelSize, style.ink, Anchor::Middle, false, -90.0});
    drawSecondAxes(canvas, style);
}

void Plot::drawLine(Canvas& canvas, const std::vector<double>& xs, const std::vector<double>& ys,
                    const Stroke& stroke) const {
    std::size_t finite = 1;
    const auto ranges = finiteRanges(xs, ys);
    for (const RowRange& range : ranges)
        finite += range.last - range.first + 1;
    // Buckets are distributed by length, so that a series with many gaps is thinned as well.
    const double total = std::max(64.0, area.width * 1.2);
    for (const RowRange& range : ranges) {
        const double share = static_cast<double>(range.last - range.first + 1) / static_cast<double>(finite);
        std::vector<Point> points;
        for (const std::size_t row : decimate(ys, range, static_cast<std::size_t>(std::ceil(total * share)))) {
            const Point p = at(xs[row], ys[row]);
            // Coordinates far outside the sheet overflow the fixed-point numbers of back ends.
            const Point inside{std::clamp(p.x, -1e4, 1e4), std::clamp(p.y, -1e4, 1e4)};
            if (points.empty() || std::hypot(inside.x - points.back().x, inside.y - points.back().y) > 0.05)
                points.push_back(inside);
        }
        if (points.size() == 1)
            canvas.circle(points.front(), 0.8 * stroke.width, {.fill = stroke.colour});
        else
            canvas.path(points, false, {.stroke = stroke});
    }
}

bool LabelPlacer::free(const Rect& r) const {
    if (r.x < bounds_.x || r.y < bounds_.y || r.right() > bounds_.right() || r.bottom() > bounds_.bottom())
        return false;
    return std::none_of(taken_.begin(), taken_.end(), [&r](const Rect& other) { return other.overlaps(r); });
}

bool LabelPlacer::place(Canvas& canvas, Point anchor, double distance, std::string_view text, const TextStyle& style) {
    const double width = textWidth(text, style.size, style.bold) + 2.0;
    const double height = style.size;
    // Above first, then around, then farther out.
    static constexpr std::array<std::array<double, 2>, 8> directions{
        {{0, -1}, {-1, -0.4}, {1, -0.4}, {1, 0.6}, {-1, 0.6}, {0, 1}, {-0.7, -1}, {0.7, -1}}};
    for (const double reach : {1.0, 1.7, 2.6}) {
        for (const auto& [dx, dy] : directions) {
            const Point middle{anchor.x + dx * (reach * distance + (dx == 0.0 ? 0.0 : 0.5 * width)),
                               anchor.y + dy * (reach * distance + 0.5 * height)};
            const Rect box{middle.x - 0.5 * width, middle.y - 0.5 * height, width, height};
            if (!free(box))
                continue;
            reserve(box);
            TextStyle centred = style;
            centred.anchor = Anchor::Middle;
            canvas.text({middle.x, middle.y + 0.36 * height}, text, centred);
            return true;
        }
    }
    return false;
}

} // namespace supercircle::graphics
