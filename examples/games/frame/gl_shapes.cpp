#include "examples/games/frame/gl_shapes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace supercircle::frame {

namespace {

using picture::Item;
using picture::Operation;
using picture::Point;

double cross(Point o, Point a, Point b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

bool inside(Point p, Point a, Point b, Point c) {
    return cross(a, b, p) >= 0.0 && cross(b, c, p) >= 0.0 && cross(c, a, p) >= 0.0;
}

/// Indices of triangles of a polygon of positive area, by cutting ears.
std::vector<std::size_t> triangles(const std::vector<Point>& p) {
    std::vector<std::size_t> left(p.size()), out;
    std::iota(left.begin(), left.end(), std::size_t{0});
    while (left.size() > 2) {
        const std::size_t n = left.size();
        std::size_t ear = 0; // of a polygon that crosses itself any
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
            const auto within = [&](std::size_t k) {
                return k != a && k != b && k != c && inside(p[k], p[a], p[b], p[c]);
            };
            if (cross(p[a], p[b], p[c]) >= 0.0 && std::none_of(left.begin(), left.end(), within)) {
                ear = i;
                break;
            }
        }
        out.insert(out.end(), {left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    return out;
}

/// Unit vector from a to b; (1, 0) where they coincide.
Point direction(Point a, Point b) {
    const double x = b.x - a.x, y = b.y - a.y, length = std::hypot(x, y);
    return length > 1e-6 ? Point{x / length, y / length} : Point{1.0, 0.0};
}

class Maker {
public:
    GlShapes take() { return std::move(out_); }

    void operator()(const Item& item) {
        n_ = item.numbers;
        switch (item.operation) {
        case Operation::Polygon:
            return polygon();
        case Operation::Band:
            return band();
        case Operation::Disc:
        case Operation::Glow: {
            GlPiece piece;
            piece.a = piece.b = {n_[0], n_[1]};
            piece.radii = {n_[2], n_[2]};
            piece.colour = rgba(n_[3], n_[4]);
            piece.glow = item.operation == Operation::Glow ? 1.0F : 0.0F;
            out_.pieces.push_back(piece);
            return add(GlBatch::Kind::Pieces, out_.pieces.size() - 1, 1);
        }
        case Operation::Text:
            out_.texts.push_back({std::string(item.text), point(0), static_cast<double>(n_[2]),
                                  picture::unpacked(n_[3], n_[4]), static_cast<int>(n_[5]), n_[6] != 0.0F,
                                  static_cast<double>(n_[7])});
            return add(GlBatch::Kind::Text, out_.texts.size() - 1, 1);
        case Operation::Clip:
            add(GlBatch::Kind::Clip, 0, 1);
            const Point at = point(0), size = point(2);
            out_.batches.back().clip = {at.x, at.y, size.x, size.y};
        }
    }

private:
    [[nodiscard]] Point point(std::size_t i) const {
        return {static_cast<double>(n_[i]), static_cast<double>(n_[i + 1])};
    }
    static std::array<std::uint8_t, 4> rgba(float colour, float alpha) {
        const auto k = static_cast<unsigned>(colour);
        return {static_cast<std::uint8_t>(k >> 16 & 255U), static_cast<std::uint8_t>(k >> 8 & 255U),
                static_cast<std::uint8_t>(k & 255U), static_cast<std::uint8_t>(std::lround(255.0F * alpha))};
    }
    void add(GlBatch::Kind kind, std::size_t first, std::size_t count) {
        if (!out_.batches.empty() && out_.batches.back().kind == kind && kind != GlBatch::Kind::Clip)
            out_.batches.back().count += count;
        else
            out_.batches.push_back({kind, first, count, {}});
    }
    void corner(Point p, std::array<std::uint8_t, 4> colour) {
        out_.corners.push_back({{static_cast<float>(p.x), static_cast<float>(p.y)}, colour});
    }
    /// Filled half a pixel inside its edges; from there to half a pixel outside it fades.
    void polygon() {
        std::vector<Point> p;
        for (std::size_t i = picture::kPolygonHead; i + 1 < n_.size(); i += picture::kPolygonStep)
            if (const Point next = point(i); p.empty() || std::hypot(next.x - p.back().x, next.y - p.back().y) > 1e-3)
                p.push_back(next);
        double area = 0.0;
        for (std::size_t i = 0; i < p.size(); ++i)
            area += cross({0.0, 0.0}, p[i], p[(i + 1) % p.size()]);
        if (area < 0.0)
            std::reverse(p.begin(), p.end());
        const std::size_t n = p.size(), before = out_.corners.size();
        if (n < 3)
            return;
        std::vector<Point> inner(n), outer(n);
        for (std::size_t i = 0; i < n; ++i) {
            const Point u = direction(p[(i + n - 1) % n], p[i]), v = direction(p[i], p[(i + 1) % n]);
            const Point normal{u.y + v.y, -u.x - v.x}; // outwards, as the area is positive
            const double k = 1.0 / std::max(normal.x * normal.x + normal.y * normal.y, 0.5);
            inner[i] = {p[i].x - k * normal.x, p[i].y - k * normal.y};
            outer[i] = {p[i].x + k * normal.x, p[i].y + k * normal.y};
        }
        const auto full = rgba(n_[0], n_[1]), none = rgba(n_[0], 0.0F);
        for (const std::size_t i : triangles(inner))
            corner(inner[i], full);
        for (std::size_t i = 0, j = n - 1; i < n; j = i++) {
            corner(inner[j], full);
            corner(outer[j], none);
            corner(outer[i], none);
            corner(inner[j], full);
            corner(outer[i], none);
            corner(inner[i], full);
        }
        add(GlBatch::Kind::Triangles, before, out_.corners.size() - before);
    }
    /// Direction of the cut at a joint between two pieces; none where the band turns by more than a right angle.
    static std::array<float, 2> cut(Point before, Point at, Point after) {
        const Point u = direction(before, at), v = direction(at, after);
        if (u.x * v.x + u.y * v.y < 0.0)
            return {};
        return {static_cast<float>(u.x + v.x), static_cast<float>(u.y + v.y)};
    }
    void band() {
        const std::size_t vertices = (n_.size() - picture::kBandHead) / picture::kBandStep;
        const bool closed = n_[1] != 0.0F;
        const std::size_t pieces = closed ? vertices : vertices - 1, first = out_.pieces.size();
        const auto place = [&](std::size_t i) { return picture::kBandHead + picture::kBandStep * (i % vertices); };
        const auto at = [&](std::size_t i) { return point(place(i)); };
        for (std::size_t i = 0; i < pieces; ++i) {
            const std::size_t a = place(i), b = place(i + 1);
            GlPiece piece;
            piece.a = {n_[a], n_[a + 1]};
            piece.b = {n_[b], n_[b + 1]};
            piece.radii = {n_[a + 2], n_[b + 2]};
            piece.colour = rgba(n_[a + 3], n_[0]);
            if (closed || i > 0)
                piece.cutA = cut(at(i + vertices - 1), at(i), at(i + 1));
            if (closed || i + 1 < pieces)
                piece.cutB = cut(at(i), at(i + 1), at(i + 2));
            out_.pieces.push_back(piece);
        }
        add(GlBatch::Kind::Pieces, first, pieces);
    }

    GlShapes out_;
    std::span<const float> n_;
};

} // namespace

GlShapes shapesOf(const picture::DrawList& list) {
    Maker maker;
    list.each([&](const Item& item) { maker(item); });
    return maker.take();
}

} // namespace supercircle::frame
