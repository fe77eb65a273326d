// The world as a draw list, and as an SVG element drawn by the canvas of the pages.

#include "bridge/box2d/box2d_port.h"
#include "bridge/c/world.h"
#include "plugin/graphics/svg_canvas.h"
#include "plugin/graphics/theme.h"
#include "supercircle/step/world.h"

#include <algorithm>
#include <cstddef>
#include <limits>

using namespace supercircle::c;
namespace graphics = supercircle::graphics;
namespace live = supercircle::live;
namespace picture = supercircle::picture;
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

sc_view checked(const sc_view* view) {
    const sc_view v = versioned(view, sc_view_init, offsetof(sc_view, pixel_ratio), "sc_view_init");
    if (v.width < 1 || v.width > kLargest || v.height < 1 || v.height > kLargest)
        refuse(SC_BAD_INPUT, "width and height must be 1 to 20000 px");
    requireFinite(v.centre, "the centre");
    if (!(v.pixels_per_metre >= 0.0 && v.pixels_per_metre < 1e9 && std::isfinite(v.alpha)))
        refuse(SC_BAD_INPUT, "pixels_per_metre and alpha must be finite, pixels_per_metre not negative");
    if (!(v.pixel_ratio >= 0.1 && v.pixel_ratio <= 10.0))
        refuse(SC_BAD_INPUT, "pixel_ratio must be 0.1 to 10");
    requireFinite(v.clock, "the clock");
    return v;
}

std::string svg(World& w, const sc_view& v) {
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

void makeList(World& w, const sc_view& v) {
    std::vector<supercircle::step::BodyOutline> outlines;
    w.attachment->everything(outlines);
    const Plane plane = planeOf(w, v, outlines);
    picture::View view;
    view.width = plane.width;
    view.height = plane.height;
    view.centre = {plane.centre.x, plane.centre.y};
    view.pixelsPerMetre = plane.scale;
    view.pixelRatio = v.pixel_ratio;
    view.reducedMotion = v.reduced_motion != 0;
    const auto has = [&](int layer) { return (v.layers & layer) != 0; };
    picture::Content content;
    if (has(SC_LAYER_BODIES))
        content.bodies = live::bodiesOf(*w.attachment, outlines);
    if (has(SC_LAYER_SHELLS))
        content.shells = live::shellsOf(w.shells, v.alpha, std::max(0.15 / plane.scale, 1e-9));
    if (!has(SC_LAYER_STRAIN))
        for (picture::Shell& s : content.shells)
            s.energy.assign(s.energy.size(), 0.0);
    live::Layers marks;
    marks.contacts = has(SC_LAYER_CONTACTS);
    marks.forces = has(SC_LAYER_FORCES);
    marks.holds = has(SC_LAYER_HOLDS);
    live::addMarks(w.shells, marks, content);
    const auto snaps = w.snaps.at(w.shells, v.clock); // read in any case: they grow old
    if (has(SC_LAYER_SNAPS))
        content.snaps = snaps;
    w.picture.clear();
    picture::addGround(w.picture, view);
    picture::addWorld(w.picture, view, content);
}

/// A part of the last list.
template <class T>
const T* part(sc_world w, int32_t* count, const char* what, const T* (*of)(const picture::DrawList&, std::size_t&)) {
    return valueIn<const T*>(w, nullptr, [&](World& x) {
        int32_t& n = given(count, what);
        if (x.picture.operations().empty())
            refuse(SC_REFUSED, "there is no picture yet: call sc_picture_make");
        std::size_t size = 0;
        const T* const data = of(x.picture, size);
        n = static_cast<int32_t>(size);
        return data;
    });
}

} // namespace

void sc_view_init(sc_view* view) {
    if (view == nullptr)
        return;
    *view = {};
    view->size = sizeof *view;
    view->width = 800;
    view->height = 600;
    view->layers = SC_LAYER_BODIES | SC_LAYER_SHELLS | SC_LAYER_STRAIN | SC_LAYER_CONTACTS | SC_LAYER_FORCES |
                   SC_LAYER_HOLDS | SC_LAYER_SNAPS;
    view->alpha = 1.0;
    view->pixel_ratio = 1.0;
}

const char* sc_picture_svg(sc_world w, const sc_view* view) {
    return textIn(w, [&](World& x) { return svg(x, checked(view)); });
}

sc_status sc_picture_make(sc_world w, const sc_view* view) {
    return use(w, [&](World& x) { makeList(x, checked(view)); });
}

const int32_t* sc_picture_operations(sc_world w, int32_t* count) {
    return part<int32_t>(w, count, "the count", [](const picture::DrawList& list, std::size_t& n) {
        n = list.operations().size();
        return list.operations().data();
    });
}

const float* sc_picture_numbers(sc_world w, int32_t* count) {
    return part<float>(w, count, "the count", [](const picture::DrawList& list, std::size_t& n) {
        n = list.numbers().size();
        return list.numbers().data();
    });
}

const char* sc_picture_texts(sc_world w, int32_t* bytes) {
    return part<char>(w, bytes, "the number of bytes", [](const picture::DrawList& list, std::size_t& n) {
        n = list.texts().size();
        return list.texts().c_str();
    });
}
