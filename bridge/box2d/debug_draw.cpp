#include "bridge/box2d/debug_draw.h"

#include "bridge/box2d/units.h"

#include <box2d/box2d.h>
#include <cmath>

namespace supercircle::bridge {

namespace {

b2Color hostColour(const Colour& c) {
    return {c.red, c.green, c.blue, c.alpha};
}

} // namespace

DrawAdapter::DrawAdapter(b2Draw& target, double units_per_metre)
    : target_(&target), scale_(std::isfinite(units_per_metre) && units_per_metre > 0.0 ? units_per_metre : 1.0) {}

void DrawAdapter::polyline(std::span<const Point> points, const Colour& colour) {
    for (std::size_t i = 1; i < points.size(); ++i)
        target_->DrawSegment(toHost(points[i - 1], scale_), toHost(points[i], scale_), hostColour(colour));
}

void DrawAdapter::outline(std::span<const Point> points, const Colour& colour) {
    polyline(points, colour);
    if (points.size() > 2)
        target_->DrawSegment(toHost(points.back(), scale_), toHost(points.front(), scale_), hostColour(colour));
}

void DrawAdapter::mark(const Point& at, const Colour& colour) {
    target_->DrawPoint(toHost(at, scale_), mark_size, hostColour(colour));
}

} // namespace supercircle::bridge
