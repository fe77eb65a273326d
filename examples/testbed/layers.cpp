#include "examples/testbed/layers.h"

#include "bridge/box2d/include/supercircle/box2d_proxies.hpp"
#include "plugin/graphics/colour_map.h"
#include "plugin/graphics/plot.h"
#include "supercircle/step/stepper.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>

namespace supercircle::testbed {

using frame::View;
using graphics::Colour;
namespace look = frame::look;

namespace {

void drawColoured(const TestbedScene& scene, const View& view, const Layers& layers) {
    const Shells& shells = scene.world().shells();
    std::vector<picture::Shell> all = scene.world().shellPictures(1.0, 0.15 / view.camera().scale());
    const std::vector<ShellHandle> handles = shells.shells();
    double most = 1e-30; // one scale for all shells
    std::vector<std::vector<double>> change(all.size());
    for (std::size_t i = 0; layers.curvature && i < all.size(); ++i)
        for (std::size_t k = 0; k < all[i].line.size(); ++k) {
            const auto section =
                shells.section(handles[i], static_cast<double>(k) / static_cast<double>(all[i].line.size()));
            change[i].push_back(section ? section->curvature - section->natural_curvature : 0.0);
            most = std::max(most, std::abs(change[i].back()));
        }
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (const double c : change[i])
            all[i].colours.push_back(graphics::signedColour(c / most));
    }
    view.shells(all);
}

/// Contact forces of the last inner step: lines as long as the square root of the force, so that weak ones are visible.
void drawContacts(const TestbedScene& scene, const View& view, const Layers& layers) {
    Shells& shells = const_cast<TestbedScene&>(scene).world().shells(); // the core is only read
    const step::Stepper& stepper = shells.stepper();
    const auto& candidates = stepper.lastCandidates();
    const auto& contacts = stepper.lastProblem().contacts;
    const Eigen::VectorXd& r = stepper.lastImpulses();
    const double dt = std::max(stepper.lastDt(), 1e-12);
    double most = 1e-30;
    const std::size_t n = std::min({candidates.size(), contacts.size(), static_cast<std::size_t>(r.size() / 2)});
    for (std::size_t i = 0; i < n; ++i)
        most = std::max(most, r[static_cast<Eigen::Index>(2 * i)] / dt);
    for (std::size_t i = 0; i < n; ++i) {
        const double rn = r[static_cast<Eigen::Index>(2 * i)], rt = r[static_cast<Eigen::Index>(2 * i + 1)];
        if (!(rn > 1e-6 * most * dt))
            continue;
        const contact::Candidate& c = candidates[i];
        const bool slips = std::abs(rt) >= (1.0 - 1e-6) * contacts[i].mu * rn;
        const Colour colour = layers.slip ? (slips ? look::bad : look::good) : look::ink;
        const graphics::Point at = view.pixel({c.pointA.x(), c.pointA.y()});
        if (layers.contacts) {
            const double size = 60.0 * std::sqrt(rn / dt / most) / std::hypot(rn, rt);
            const double x = rn * c.normal.x() - rt * c.normal.y(), y = rn * c.normal.y() + rt * c.normal.x();
            view.canvas().line(at, {at.x + size * x, at.y - size * y}, {colour, 2.2});
        }
        view.canvas().circle(at, 3.4, {.fill = colour});
    }
}

void drawBox(const View& view, Point lower, Point upper, const Colour& colour) {
    const graphics::Point a = view.pixel({lower.x, upper.y}), b = view.pixel({upper.x, lower.y});
    view.canvas().rectangle({a.x, a.y, b.x - a.x, b.y - a.y}, {.stroke = graphics::Stroke{colour, 1.0}});
}

void drawBoxes(const TestbedScene& scene, const View& view) {
    for (const ShellHandle shell : scene.world().shells().shells())
        if (const auto m = scene.world().shells().state(shell))
            drawBox(view, m->box.lower, m->box.upper, look::accent.alpha(0.7));
    const double u = scene.world().units();
    for (const frame::BodyPose& pose : scene.world().bodies(1.0))
        for (const b2Fixture* f = pose.body->GetFixtureList(); f != nullptr; f = f->GetNext()) {
            const b2AABB box = f->GetAABB(0);
            drawBox(view, {static_cast<double>(box.lowerBound.x) / u, static_cast<double>(box.lowerBound.y) / u},
                    {static_cast<double>(box.upperBound.x) / u, static_cast<double>(box.upperBound.y) / u},
                    look::looseEdge.alpha(0.7));
        }
}

/// The edges that ShellProxies makes, in a world of their own: the scene's own world stays as it is.
void drawProxies(const TestbedScene& scene, const View& view) {
    b2World world({0.0F, 0.0F});
    const double u = scene.world().units();
    bridge::ShellProxies proxies(world, u);
    proxies.begin();
    if (!scene.world().shells().draw(proxies, bridge::ShellProxies::options()) || !proxies.end())
        return;
    for (const b2Body* b = world.GetBodyList(); b != nullptr; b = b->GetNext())
        for (const b2Fixture* f = b->GetFixtureList(); f != nullptr; f = f->GetNext())
            if (const auto* e = dynamic_cast<const b2EdgeShape*>(f->GetShape())) {
                const auto place = [&](const b2Vec2& p) {
                    const b2Vec2 w = b->GetWorldPoint(p);
                    return Point{static_cast<double>(w.x) / u, static_cast<double>(w.y) / u};
                };
                view.line(place(e->m_vertex1), place(e->m_vertex2), Colour::hex(0x8b5fbf), 1.2);
                view.canvas().circle(view.pixel(place(e->m_vertex1)), 1.8, {.fill = Colour::hex(0x8b5fbf)});
            }
}

struct Line {
    const char* name;
    const std::vector<double>* values;
    Colour colour;
};

void drawPlot(frame::Canvas& canvas, const graphics::Rect& area, const std::string& title, const std::string& xLabel,
              const std::vector<double>& xs, double xScale, const std::string& yUnit, const std::vector<Line>& lines) {
    using namespace graphics;
    canvas.rectangle(area, {.fill = look::strip, .stroke = Stroke{look::rule, 1.0}});
    canvas.text({area.x + 14.0, area.y + 22.0}, title, {.size = 14.0, .colour = look::ink, .bold = true});
    AxisRange x{0.0, 0.0}, y{0.0, 0.0};
    for (const double v : xs)
        x = {std::min(x.lo, v), std::max(x.hi, v)};
    for (const Line& line : lines)
        for (const double v : *line.values)
            y = {std::min(y.lo, v), std::max(y.hi, v)};
    if (!(x.span() > 0.0))
        x.hi = x.lo + 1e-3;
    if (!(y.span() > 0.0))
        y.hi = y.lo + 1e-3;
    const DisplayUnit unit = readableUnit(std::max(std::abs(y.lo), std::abs(y.hi)), yUnit);
    const Rect inner{area.x + 62.0, area.y + 36.0, area.width - 80.0, area.height - 84.0};
    const Plot plot(inner, x, padded(y, 0.05));
    PlotStyle style;
    style.x = {xLabel, xScale};
    style.y = {unit.text, unit.factor};
    style.xTicks = style.yTicks = 5;
    style.ink = look::ink;
    style.muted = look::muted;
    style.grid = style.axis = look::rule;
    plot.drawFrame(canvas, style);
    double legend = area.right() - 14.0;
    for (auto line = lines.rbegin(); line != lines.rend(); ++line) {
        plot.drawLine(canvas, xs, *line->values, {line->colour, 2.0});
        if (lines.size() < 2)
            continue;
        canvas.text({legend, area.y + 22.0}, line->name,
                    {.size = 11.0, .colour = line->colour, .anchor = Anchor::End, .bold = true});
        legend -= textWidth(line->name, 11.0, true) + 8.0;
    }
}

} // namespace

const std::vector<std::string>& layers() {
    static const std::vector<std::string> names{"curvature", "energy", "contacts", "slip", "proxies", "boxes"};
    return names;
}

std::vector<std::pair<const char*, bool*>> Layers::all() {
    return {{"curvature", &curvature}, {"energy", &energy},   {"contacts", &contacts},
            {"slip", &slip},           {"proxies", &proxies}, {"boxes", &boxes}};
}

std::string Layers::set(const std::string& names) {
    for (const auto& [name, on] : all())
        *on = false;
    for (std::size_t begin = 0; begin < names.size();) {
        const std::size_t end = std::min(names.find(',', begin), names.size());
        const std::string word = names.substr(begin, end - begin);
        bool known = false;
        for (const auto& [name, on] : all())
            if (word == name)
                known = *on = true;
        if (!known)
            return word;
        begin = end + 1;
    }
    return {};
}

void drawScene(TestbedScene& scene, const View& view, const Layers& layers, double alpha) {
    view.bodies(scene.world(), alpha);
    if (layers.curvature || layers.energy)
        drawColoured(scene, view, layers);
    else
        view.shells(scene.world(), alpha);
    if (layers.proxies)
        drawProxies(scene, view);
    if (layers.boxes)
        drawBoxes(scene, view);
    if (layers.contacts || layers.slip)
        drawContacts(scene, view, layers);
    view.drag(scene.world());
    view.snaps(scene.world());
}

void drawCurves(const TestbedScene& scene, frame::Canvas& canvas, const graphics::Rect& area) {
    const Curves& c = scene.curves();
    const double half = 0.5 * (area.height - 12.0);
    const bool hasProtocol = scene.world().scene().protocol.has_value();
    const graphics::Rect top{area.x, area.y, area.width, half};
    if (hasProtocol)
        drawPlot(canvas, top, "Force and displacement", "mm", c.travel, 1e3, "N", {{"force", &c.force, look::bad}});
    else
        drawPlot(canvas, top, "Kinetic energy", "s", c.time, 1.0, "J", {{"kinetic", &c.kinetic, look::bad}});
    drawPlot(canvas, {area.x, area.y + half + 12.0, area.width, half}, "Energy balance", "s", c.time, 1.0, "J",
             {{"bending", &c.bending, look::accent},
              {"friction", &c.friction, look::bad},
              {"lost", &c.losses, look::muted}});
}

} // namespace supercircle::testbed
