#include "plugin/graphics/picture/list_canvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace supercircle::picture {

namespace {

Point between(Point a, Point b, double t) {
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

} // namespace

void ListCanvas::path(const std::vector<Point>& points, bool closed, const graphics::Paint& paint) {
    if (paint.fill)
        list_->polygon(points, *paint.fill);
    if (paint.stroke)
        stroke(points, closed, *paint.stroke);
}

void ListCanvas::stroke(const std::vector<Point>& points, bool closed, const graphics::Stroke& s) {
    double period = 0.0;
    for (const double d : s.dash)
        period += d;
    if (!(period > 0.0))
        return list_->line(points, closed, 0.5 * s.width, s.colour);
    double left = s.dash.front(); // of the present dash or gap
    std::size_t k = 0;
    bool drawn = true;
    std::vector<Point> piece;
    const std::size_t edges = points.size() - (closed ? 0 : 1);
    for (std::size_t i = 0; i < edges; ++i) {
        const Point a = points[i], b = points[(i + 1) % points.size()];
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        if (drawn && piece.empty())
            piece = {a};
        for (double done = 0.0; done < length;) {
            const double part = std::min(left, length - done);
            done += part;
            left -= part;
            if (drawn)
                piece.push_back(between(a, b, done / length));
            if (left > 0.0)
                continue;
            if (drawn)
                list_->line(piece, false, 0.5 * s.width, s.colour);
            drawn = !drawn;
            piece.clear();
            if (drawn)
                piece = {between(a, b, done / length)};
            k = (k + 1) % s.dash.size();
            left = std::max(s.dash[k], 1e-3);
        }
    }
    if (drawn)
        list_->line(piece, false, 0.5 * s.width, s.colour);
}

void ListCanvas::circle(Point centre, double radius, const graphics::Paint& paint) {
    if (paint.fill)
        list_->disc(centre, radius, *paint.fill);
    if (!paint.stroke)
        return;
    // A polygon that deviates by a tenth of a pixel at most.
    const double step = std::sqrt(8.0 * 0.1 / std::max(radius, 1.0));
    const auto n = static_cast<std::size_t>(std::clamp(2.0 * std::numbers::pi / step, 12.0, 720.0));
    std::vector<Point> points;
    for (std::size_t i = 0; i < n; ++i) {
        const double a = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
        points.push_back({centre.x + radius * std::cos(a), centre.y + radius * std::sin(a)});
    }
    stroke(points, true, *paint.stroke);
}

void ListCanvas::text(Point at, std::string_view text, const graphics::TextStyle& style) {
    list_->text(at, text, {style.size, style.colour, style.anchor, style.bold, style.rotation});
}

void ListCanvas::pushClip(const Rect& area) {
    const Rect& now = clips_.back();
    const double x = std::max(now.x, area.x), y = std::max(now.y, area.y);
    clips_.push_back({x, y, std::max(std::min(now.right(), area.right()) - x, 0.0),
                      std::max(std::min(now.bottom(), area.bottom()) - y, 0.0)});
    list_->clip(clips_.back());
}

void ListCanvas::popClip() {
    if (clips_.size() > 1)
        clips_.pop_back();
    list_->clip(clips_.back());
}

} // namespace supercircle::picture
