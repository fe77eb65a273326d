#include "plugin/graphics/picture/draw_list.h"

#include <algorithm>
#include <cmath>

namespace supercircle::picture {

namespace {

constexpr double kFarthest = 1e7; ///< px: what rasterisers with fixed point take, and far beyond any picture

double share(double x) {
    return x > 0.0 ? std::min(x, 1.0) : 0.0; // NaN: 0
}
double channel(double c) {
    return std::round(255.0 * share(c));
}

} // namespace

float packed(const Colour& c) {
    return static_cast<float>(65536.0 * channel(c.r) + 256.0 * channel(c.g) + channel(c.b));
}

Colour unpacked(float colour, float alpha) {
    return Colour::hex(static_cast<unsigned>(colour), static_cast<double>(alpha));
}

void DrawList::clear() {
    operations_.clear();
    numbers_.clear();
    texts_.clear();
}

void DrawList::begin(Operation operation) {
    operations_.push_back(static_cast<std::int32_t>(operation));
    operations_.push_back(0);
}

void DrawList::put(double number) {
    const double finite = std::isnan(number) ? kFarthest : std::clamp(number, -kFarthest, kFarthest);
    numbers_.push_back(static_cast<float>(finite));
    ++operations_.back();
}

void DrawList::put(Point p) {
    put(p.x);
    put(p.y);
}

void DrawList::put(const Colour& colour) {
    numbers_.push_back(packed(colour));
    ++operations_.back();
}

void DrawList::polygon(std::span<const Point> corners, const Colour& fill) {
    if (corners.size() < 3)
        return;
    begin(Operation::Polygon);
    put(fill);
    put(share(fill.a));
    for (const Point& p : corners)
        put(p);
}

void DrawList::band(std::span<const BandVertex> vertices, bool closed, double alpha) {
    if (vertices.size() < 2)
        return;
    begin(Operation::Band);
    put(share(alpha));
    put(closed ? 1.0 : 0.0);
    for (const BandVertex& v : vertices) {
        put(v.at);
        put(std::max(v.halfWidth, 0.0));
        put(alpha < 1.0 ? vertices.front().colour : v.colour);
    }
}

void DrawList::line(std::span<const Point> points, bool closed, double halfWidth, const Colour& colour) {
    std::vector<BandVertex> vertices;
    vertices.reserve(points.size());
    for (const Point& p : points)
        vertices.push_back({p, halfWidth, colour});
    band(vertices, closed, colour.a);
}

void DrawList::disc(Point centre, double radius, const Colour& fill) {
    begin(Operation::Disc);
    put(centre);
    put(std::max(radius, 0.0));
    put(fill);
    put(share(fill.a));
}

void DrawList::glow(Point centre, double radius, const Colour& colour, double strength) {
    begin(Operation::Glow);
    put(centre);
    put(std::max(radius, 0.0));
    put(colour);
    put(share(strength));
}

void DrawList::text(Point at, std::string_view text, const TextLook& look) {
    begin(Operation::Text);
    put(at);
    put(std::max(look.size, 0.0));
    put(look.colour);
    put(share(look.colour.a));
    put(look.anchor == Anchor::Start ? 0.0 : look.anchor == Anchor::Middle ? 1.0 : 2.0);
    put(look.bold ? 1.0 : 0.0);
    put(look.angle);
    texts_ += text.substr(0, text.find('\0'));
    texts_ += '\0';
}

void DrawList::clip(const Rect& area) {
    begin(Operation::Clip);
    put(Point{area.x, area.y});
    put(Point{std::max(area.width, 0.0), std::max(area.height, 0.0)});
}

void DrawList::each(const std::function<void(const Item&)>& visit) const {
    std::span<const float> left = numbers_;
    std::string_view texts = texts_;
    for (std::size_t i = 0; i + 1 < operations_.size(); i += 2) {
        const auto count = static_cast<std::size_t>(operations_[i + 1]);
        Item item{static_cast<Operation>(operations_[i]), left.first(count), {}};
        left = left.subspan(count);
        if (item.operation == Operation::Text) {
            item.text = texts.substr(0, texts.find('\0'));
            texts.remove_prefix(item.text.size() + 1);
        }
        visit(item);
    }
}

} // namespace supercircle::picture
