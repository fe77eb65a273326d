#include "examples/games/frame/view.h"

#include <box2d/box2d.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace supercircle::frame {

using graphics::Stroke;

std::string number(double value, int digits) {
    char buffer[64];
    const double unit = std::pow(10.0, -digits);
    const double shown = std::abs(value) < 0.5 * unit ? 0.0 : value; // no "-0.0"
    std::snprintf(buffer, sizeof buffer, "%.*f", digits, shown);
    return buffer;
}

void Camera::resize(double width, double height, double left) {
    width_ = width;
    height_ = height;
    left_ = left;
}

double Camera::scale() const {
    const double w = width_ - left_, h = height_ - look::top - look::bottom;
    return zoom_ * std::max(1e-9, std::min(w / (upper_.x - lower_.x), h / (upper_.y - lower_.y)));
}

graphics::Point Camera::pixel(Point p) const {
    const double s = scale();
    const double cx = 0.5 * (left_ + width_), cy = 0.5 * (look::top + height_ - look::bottom);
    return {cx + s * (p.x - 0.5 * (lower_.x + upper_.x) - shift_.x),
            cy - s * (p.y - 0.5 * (lower_.y + upper_.y) - shift_.y)};
}

Point Camera::world(graphics::Point p) const {
    const double s = scale();
    const double cx = 0.5 * (left_ + width_), cy = 0.5 * (look::top + height_ - look::bottom);
    return {0.5 * (lower_.x + upper_.x) + shift_.x + (p.x - cx) / s,
            0.5 * (lower_.y + upper_.y) + shift_.y - (p.y - cy) / s};
}

void Camera::zoom(double factor, graphics::Point at) {
    const Point before = world(at);
    zoom_ = std::clamp(zoom_ * factor, 0.2, 50.0);
    const Point after = world(at);
    shift_ = {shift_.x + before.x - after.x, shift_.y + before.y - after.y};
}

void Camera::pan(double dx, double dy) {
    shift_ = {shift_.x - dx / scale(), shift_.y + dy / scale()};
}

View::View(picture::ListCanvas& canvas, const Camera& camera, double width, double height)
    : canvas_(&canvas), camera_(&camera), width_(width), height_(height) {
    const Point middle = camera.world({0.5 * width, 0.5 * height});
    seen_.width = width;
    seen_.height = height;
    seen_.centre = {middle.x, middle.y};
    seen_.pixelsPerMetre = camera.scale();
}

void View::background() const {
    picture::addGround(canvas_->list(), seen_);
}

void View::bodies(const GameWorld& world, double alpha, const std::function<Style(const b2Body&)>& style) const {
    std::vector<picture::Body> all;
    for (const BodyPose& pose : world.bodies(alpha)) {
        if (!pose.body->IsEnabled())
            continue;
        const Style look = style ? style(*pose.body) : Style{};
        for (picture::Body& piece : world.pieces(pose)) {
            piece.fill = look.fill;
            piece.edge = look.edge;
            all.push_back(std::move(piece));
        }
    }
    picture::addBodies(canvas_->list(), seen_, all);
}

void View::shells(const GameWorld& world, double alpha, const std::function<Colour(ShellHandle)>& colour) const {
    std::vector<picture::Shell> all = world.shellPictures(alpha, 0.15 / camera_->scale());
    const std::vector<ShellHandle> handles = world.shells().shells();
    for (std::size_t i = 0; i < all.size() && i < handles.size(); ++i) {
        all[i].tint = colour ? colour(handles[i]) : Colour::hex(world.colour(handles[i]));
        all[i].thickness = std::max(all[i].thickness, thinnest());
    }
    shells(all);
}

void View::snaps(GameWorld& world) const {
    picture::addSnaps(canvas_->list(), seen_, world.snaps());
}

void View::ghost(const std::vector<Point>& line, const Colour& colour) const {
    picture::Shell shell;
    for (const Point& p : line)
        shell.line.push_back({p.x, p.y});
    shell.colours.assign(line.size(), colour);
    shell.thickness = thinnest();
    picture::addShell(canvas_->list(), seen_, shell, colour.a);
}

void View::drag(const GameWorld& world) const {
    if (!world.dragging())
        return;
    line(world.dragPoint(), world.dragTarget(), look::accent, 2.0, true);
    canvas_->circle(pixel(world.dragPoint()), 5.0, {.fill = look::accent});
    canvas_->circle(pixel(world.dragTarget()), 9.0, {.stroke = Stroke{look::accent, 2.0}});
}

void View::disc(Point centre, double radius, const Style& style) const {
    picture::Body body{.points = {{centre.x, centre.y}}, .radius = radius, .role = picture::Role::Loose};
    body.fill = style.fill;
    body.edge = style.edge;
    picture::addBodies(canvas_->list(), seen_, {body});
}

void View::line(Point a, Point b, const Colour& colour, double width, bool dashed) const {
    canvas_->line(pixel(a), pixel(b), {colour, width, dashed ? std::vector<double>{5.0, 6.0} : std::vector<double>{}});
}

void View::area(Point lower, Point upper, const Colour& colour, const std::string& text) const {
    const graphics::Point a = pixel({lower.x, upper.y}), b = pixel({upper.x, lower.y});
    canvas_->rectangle({a.x, a.y, b.x - a.x, b.y - a.y},
                       {.fill = colour.alpha(0.14), .stroke = Stroke{colour, 1.5, {6.0, 5.0}}});
    canvas_->text({a.x + 6.0, a.y + 17.0}, text, {.size = 13.0, .colour = colour, .bold = true});
}

void View::label(Point at, const std::string& text, const Colour& colour, double size) const {
    const graphics::Point p = pixel(at);
    canvas_->text({p.x, p.y}, text, {.size = size, .colour = colour, .anchor = graphics::Anchor::Middle});
}

void drawStrips(const View& view, const std::string& title, const std::vector<StatusEntry>& status,
                const std::string& hint, const std::string& corner) {
    Canvas& c = view.canvas();
    const double w = view.width(), h = view.height();
    c.rectangle({0, 0, w, look::top}, {.fill = look::strip});
    c.line({0, look::top}, {w, look::top}, {look::rule, 1.0});
    c.rectangle({0, h - look::bottom, w, look::bottom}, {.fill = look::strip});
    c.line({0, h - look::bottom}, {w, h - look::bottom}, {look::rule, 1.0});
    c.text({18.0, 33.0}, title, {.size = 19.0, .colour = look::ink, .bold = true});
    double x = w - 18.0; // from the right, the first one leftmost
    for (auto it = status.rbegin(); it != status.rend(); ++it) {
        const double wide =
            std::max({graphics::textWidth(it->name, 11.0), graphics::textWidth(it->value, 17.0, true), 50.0});
        c.text({x - wide, 19.0}, it->name, {.size = 11.0, .colour = look::muted});
        c.text({x - wide, 41.0}, it->value, {.size = 17.0, .colour = it->colour, .bold = true});
        x -= wide + 22.0;
    }
    c.text({18.0, h - 12.0}, hint, {.size = 13.0, .colour = look::muted});
    if (!corner.empty())
        c.text({w - 18.0, h - 12.0}, corner, {.size = 13.0, .colour = look::muted, .anchor = graphics::Anchor::End});
}

void drawCard(const View& view, const std::string& title, const std::vector<std::string>& lines, const Colour& colour) {
    Canvas& c = view.canvas();
    double wide = graphics::textWidth(title, 30.0, true);
    for (const std::string& line : lines)
        wide = std::max(wide, graphics::textWidth(line, 16.0));
    wide += 70.0;
    const double high = 86.0 + 26.0 * static_cast<double>(lines.size());
    const double x = 0.5 * (view.width() - wide), y = std::max(look::top + 10.0, 0.34 * view.height() - 0.5 * high);
    c.rectangle({x, y, wide, high}, {.fill = look::strip.alpha(0.94), .stroke = Stroke{colour, 2.0}});
    c.rectangle({x, y, wide, 6.0}, {.fill = colour});
    c.text({x + 0.5 * wide, y + 52.0}, title,
           {.size = 30.0, .colour = colour, .anchor = graphics::Anchor::Middle, .bold = true});
    for (std::size_t i = 0; i < lines.size(); ++i)
        c.text({x + 0.5 * wide, y + 84.0 + 26.0 * static_cast<double>(i)}, lines[i],
               {.size = 16.0, .colour = look::ink, .anchor = graphics::Anchor::Middle});
}

void drawHelp(const View& view, const std::vector<std::pair<std::string, std::string>>& keys) {
    Canvas& c = view.canvas();
    double first = 0.0, second = 0.0;
    for (const auto& [key, what] : keys) {
        first = std::max(first, graphics::textWidth(key, 14.0, true));
        second = std::max(second, graphics::textWidth(what, 14.0));
    }
    const double wide = first + second + 62.0, high = 28.0 + 24.0 * static_cast<double>(keys.size());
    const double x = view.width() - wide - 16.0, y = look::top + 16.0;
    c.rectangle({x, y, wide, high}, {.fill = look::strip.alpha(0.95), .stroke = Stroke{look::rule, 1.0}});
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const double base = y + 30.0 + 24.0 * static_cast<double>(i);
        c.text({x + 18.0, base}, keys[i].first, {.size = 14.0, .colour = look::accent, .bold = true});
        c.text({x + 36.0 + first, base}, keys[i].second, {.size = 14.0, .colour = look::ink});
    }
}

void drawEnergy(const View& view, double x, double y, const std::string& title,
                const std::vector<std::pair<std::string, double>>& joules, const std::vector<Colour>& colours) {
    Canvas& c = view.canvas();
    double most = 1.0;
    for (const auto& entry : joules)
        most = std::max(most, entry.second);
    const double high = 44.0 + 24.0 * static_cast<double>(joules.size());
    c.rectangle({x, y, 300.0, high}, {.fill = look::strip.alpha(0.9), .stroke = Stroke{look::rule, 1.0}});
    c.text({x + 14.0, y + 24.0}, title, {.size = 14.0, .colour = look::ink, .bold = true});
    for (std::size_t i = 0; i < joules.size(); ++i) {
        const double base = y + 50.0 + 24.0 * static_cast<double>(i);
        c.text({x + 14.0, base}, joules[i].first, {.size = 13.0, .colour = look::muted});
        const double bar = 110.0 * std::max(0.0, joules[i].second) / most;
        c.rectangle({x + 104.0, base - 11.0, std::max(bar, 1.0), 13.0}, {.fill = colours[i % colours.size()]});
        c.text({x + 286.0, base}, number(std::max(0.0, joules[i].second), joules[i].second < 10.0 ? 1 : 0) + " J",
               {.size = 13.0, .colour = look::ink, .anchor = graphics::Anchor::End});
    }
}

} // namespace supercircle::frame
