// The world as an SVG element, drawn by the canvas of the pages.

#include "bridge/box2d/box2d_port.h"
#include "bridge/c/world.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/graphics/theme.h"
#include "supercircle/step/world.h"

#include <algorithm>
#include <limits>

using namespace supercircle::c;
namespace graphics = supercircle::graphics;
using supercircle::Colour;
using supercircle::DrawOptions;
using supercircle::Point;

namespace {

constexpr int32_t kLargest = 20000; ///< px
constexpr double kMargin = 0.05;    ///< of the picture, on each side

/// Metres to pixels, y downwards.
struct Plane {
    double scale = 1.0;
    Point centre{};
    double width = 0.0, height = 0.0;
    [[nodiscard]] graphics::Point at(const Point& p) const {
        return {0.5 * width + scale * (p.x - centre.x), 0.5 * height - scale * (p.y - centre.y)};
    }
};

class SvgDraw final : public supercircle::DebugDraw {
public:
    SvgDraw(graphics::SvgCanvas& canvas, const Plane& plane) : canvas_(canvas), plane_(plane) {}
    void polyline(std::span<const Point> points, const Colour& colour) override { draw(points, false, colour, 1.6); }
    void outline(std::span<const Point> points, const Colour& colour) override { draw(points, true, colour, 0.8); }
    void mark(const Point& at, const Colour& colour) override {
        canvas_.circle(plane_.at(at), 2.5, {.fill = paint(colour)});
    }

private:
    static graphics::Colour paint(const Colour& c) {
        return {static_cast<double>(c.red), static_cast<double>(c.green), static_cast<double>(c.blue),
                static_cast<double>(c.alpha)};
    }
    void draw(std::span<const Point> points, bool closed, const Colour& colour, double width) {
        std::vector<graphics::Point> out;
        for (const Point& p : points)
            out.push_back(plane_.at(p));
        canvas_.path(out, closed, {.stroke = graphics::Stroke{paint(colour), width}});
    }
    graphics::SvgCanvas& canvas_;
    const Plane& plane_;
};

struct Extent {
    Point lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Point upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    void add(const Point& p) {
        lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
        upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
    }
};

/// The shells, with as much of the bodies as lies near them; the bodies where there are no shells.
Extent extentOf(World& w, const std::vector<supercircle::step::BodyOutline>& outlines) {
    Extent all;
    for (const auto& shell : w.shells.shells()) {
        const auto state = w.shells.state(shell);
        if (state && !state->quarantined) {
            all.add(state->box.lower);
            all.add(state->box.upper);
        }
    }
    if (all.lower.x <= all.upper.x)
        return all;
    for (const auto& o : outlines) {
        supercircle::step::BodyState s;
        if (!w.attachment->state(o.body, s))
            continue;
        for (const auto& p : supercircle::step::placed(o, s.centre, s.angle).points)
            all.add({p.x(), p.y()});
    }
    return all;
}

Plane planeOf(World& w, const sc_view& v, const std::vector<supercircle::step::BodyOutline>& outlines) {
    Plane plane{v.pixels_per_metre, in(v.centre), static_cast<double>(v.width), static_cast<double>(v.height)};
    if (v.pixels_per_metre > 0.0)
        return plane;
    const Extent e = extentOf(w, outlines);
    const double x = e.upper.x - e.lower.x, y = e.upper.y - e.lower.y;
    if (!(std::isfinite(x) && std::isfinite(y)))
        return {100.0, {}, plane.width, plane.height}; // an empty world
    const double inner = 1.0 - 2.0 * kMargin;
    plane.centre = {0.5 * (e.lower.x + e.upper.x), 0.5 * (e.lower.y + e.upper.y)};
    plane.scale = inner * std::min(plane.width / std::max(x, 1e-6), plane.height / std::max(y, 1e-6));
    return plane;
}

void drawBodies(World& w, const std::vector<supercircle::step::BodyOutline>& outlines, const Plane& plane,
                graphics::SvgCanvas& canvas) {
    for (const auto& o : outlines) {
        supercircle::step::BodyState s;
        if (!w.attachment->state(o.body, s))
            continue;
        const auto placed = supercircle::step::placed(o, s.centre, s.angle);
        std::vector<graphics::Point> points;
        for (const auto& p : placed.points)
            points.push_back(plane.at({p.x(), p.y()}));
        const graphics::Stroke edge{graphics::theme::bodyEdge, 1.0};
        const bool solid = o.local.kind == supercircle::contact::OutlineKind::Polygon;
        if (points.size() == 1)
            canvas.circle(points.front(), plane.scale * placed.radius, {graphics::theme::body, edge});
        else
            canvas.path(points, solid, {solid ? std::optional(graphics::theme::body) : std::nullopt, edge});
    }
}

std::string svg(World& w, const sc_view& v) {
    if (v.width < 1 || v.width > kLargest || v.height < 1 || v.height > kLargest)
        refuse(SC_BAD_INPUT, "width and height must be 1 to 20000 px");
    requireFinite(v.centre, "the centre");
    if (!(v.pixels_per_metre >= 0.0 && v.pixels_per_metre < 1e9 && std::isfinite(v.alpha)))
        refuse(SC_BAD_INPUT, "pixels_per_metre and alpha must be finite, pixels_per_metre not negative");
    std::vector<supercircle::step::BodyOutline> outlines;
    w.attachment->everything(outlines);
    const Plane plane = planeOf(w, v, outlines);
    graphics::SvgCanvas canvas(plane.width, plane.height, "supercircle", "shells and bodies");
    const auto has = [&](int layer) { return (v.layers & layer) != 0; };
    if (has(SC_LAYER_BODIES))
        drawBodies(w, outlines, plane, canvas);
    DrawOptions options;
    options.outlines = options.centre_lines = has(SC_LAYER_SHELLS);
    options.strain = has(SC_LAYER_STRAIN);
    options.contacts = has(SC_LAYER_CONTACTS);
    options.forces = has(SC_LAYER_FORCES);
    options.holds = has(SC_LAYER_HOLDS);
    options.tolerance = std::max(0.1 / plane.scale, 1e-9);
    options.metres_per_newton = 30.0 / plane.scale; // 1 N is 30 px long
    options.alpha = v.alpha;
    SvgDraw draw(canvas, plane);
    done(w.shells.draw(draw, options));
    return canvas.finish();
}

} // namespace

void sc_view_init(sc_view* view) {
    if (view == nullptr)
        return;
    *view = {};
    view->size = sizeof *view;
    view->width = 800;
    view->height = 600;
    view->layers =
        SC_LAYER_BODIES | SC_LAYER_SHELLS | SC_LAYER_STRAIN | SC_LAYER_CONTACTS | SC_LAYER_FORCES | SC_LAYER_HOLDS;
    view->alpha = 1.0;
}

const char* sc_picture_svg(sc_world w, const sc_view* view) {
    return textIn(w, [&](World& x) { return svg(x, versioned(view, sc_view_init, sizeof(sc_view), "sc_view_init")); });
}
