#pragma once
// A canvas with two back ends (SVG text, Cairo pixels), so that a page and the PNG files come from one drawing.
// Coordinates: pixels of the logical sheet, y downwards.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::graphics {

struct Colour {
    double r = 0.0, g = 0.0, b = 0.0, a = 1.0; ///< sRGB, 0 .. 1
    /// From 0xRRGGBB.
    static constexpr Colour hex(unsigned rgb, double alpha = 1.0) {
        return {((rgb >> 16) & 255) / 255.0, ((rgb >> 8) & 255) / 255.0, (rgb & 255) / 255.0, alpha};
    }
    [[nodiscard]] constexpr Colour alpha(double value) const { return {r, g, b, value}; }
};

/// "#rrggbb"
[[nodiscard]] std::string hexText(const Colour& colour);

/// Pixels of a sheet, or metres of the plane where a function says so.
struct Point {
    double x = 0.0, y = 0.0;
};

struct Rect {
    double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
    [[nodiscard]] double right() const { return x + width; }
    [[nodiscard]] double bottom() const { return y + height; }
    [[nodiscard]] bool overlaps(const Rect& o) const {
        return x < o.right() && o.x < right() && y < o.bottom() && o.y < bottom();
    }
};

struct Stroke {
    Colour colour;
    double width = 1.0;
    std::vector<double> dash = {};
};

/// Fill, outline or both. Outlines have round joints and round ends.
struct Paint {
    std::optional<Colour> fill = {};
    std::optional<Stroke> stroke = {};
};

enum class Anchor { Start, Middle, End };

struct TextStyle {
    double size = 13.0;
    Colour colour = Colour::hex(0x1b1f24);
    Anchor anchor = Anchor::Start;
    bool bold = false;
    double rotation = 0.0; ///< degrees, clockwise about the text's anchor
};

class Canvas {
public:
    Canvas() = default;
    Canvas(const Canvas&) = delete;
    Canvas& operator=(const Canvas&) = delete;
    virtual ~Canvas() = default;

    virtual void path(const std::vector<Point>& points, bool closed, const Paint& paint) = 0;
    virtual void circle(Point centre, double radius, const Paint& paint) = 0;
    /// Base line at `at`.
    virtual void text(Point at, std::string_view text, const TextStyle& style) = 0;
    virtual void pushClip(const Rect& area) = 0;
    virtual void popClip() = 0;

    void line(Point a, Point b, const Stroke& stroke) { path({a, b}, false, {.stroke = stroke}); }
    void rectangle(const Rect& r, const Paint& paint) {
        path({{r.x, r.y}, {r.right(), r.y}, {r.right(), r.bottom()}, {r.x, r.bottom()}}, true, paint);
    }
};

/// Width of a text for layout, px: an upper estimate from the metrics of a wide font. Readers have different fonts, and
/// both back ends need the same layout.
[[nodiscard]] double textWidth(std::string_view text, double size, bool bold = false);

} // namespace supercircle::graphics
