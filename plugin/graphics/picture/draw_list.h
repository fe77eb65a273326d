#pragma once
// A picture as a list of six operations on pixels, drawn by small back ends (decision 0202): Cairo, canvas 2D, OpenGL.
// The back ends decide nothing: what a picture looks like stands in the list. docs/reference/picture.md has the format.

#include "plugin/graphics/canvas.h"

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace supercircle::picture {

using graphics::Anchor;
using graphics::Colour;
using graphics::Point;
using graphics::Rect;

enum class Operation : std::int32_t {
    Polygon = 1, ///< colour, alpha, then x, y of each corner
    Band = 2,    ///< alpha, closed, then x, y, half width, colour of each vertex
    Disc = 3,    ///< x, y, radius, colour, alpha
    Glow = 4,    ///< x, y, radius, colour, strength
    Text = 5,    ///< x, y of the base line, size, colour, alpha, anchor, bold, angle; the text stands in texts()
    Clip = 6     ///< x, y, width, height of what the following operations may touch
};

inline constexpr std::size_t kPolygonHead = 2, kPolygonStep = 2; ///< numbers before the corners, numbers of a corner
inline constexpr std::size_t kBandHead = 2, kBandStep = 4;       ///< the same of a band

/// A vertex of a band, px. The piece from a vertex to the next one has the colour of the first.
struct BandVertex {
    Point at{};
    double halfWidth = 1.0;
    Colour colour{}; ///< without its alpha
};

struct TextLook {
    double size = 13.0; ///< px
    Colour colour{};
    Anchor anchor = Anchor::Start;
    bool bold = false;
    double angle = 0.0; ///< clockwise about its anchor, degrees
};

/// 65536 red + 256 green + blue, each 0 to 255: exact in a float.
[[nodiscard]] float packed(const Colour& colour);
[[nodiscard]] Colour unpacked(float colour, float alpha = 1.0F);

/// One operation, for back ends.
struct Item {
    Operation operation;
    std::span<const float> numbers;
    std::string_view text; ///< of Operation::Text
};

/// The list. Numbers that are not finite, and those beyond 1e7 px, never enter it: they become the nearest of 1e7 px.
class DrawList {
public:
    void clear();
    /// Filled, three corners at least.
    void polygon(std::span<const Point> corners, const Colour& fill);
    /// A line with round ends and joints, two vertices at least; closed: back to the first one. A band with an alpha
    /// below 1 has one colour, so that no piece is seen through another one.
    void band(std::span<const BandVertex> vertices, bool closed, double alpha = 1.0);
    /// The same with one width and colour.
    void line(std::span<const Point> points, bool closed, double halfWidth, const Colour& colour);
    void disc(Point centre, double radius, const Colour& fill);
    /// Adds light: colour times strength times (1 - d^2 / r^2)^2 at the distance d from the centre.
    void glow(Point centre, double radius, const Colour& colour, double strength);
    void text(Point at, std::string_view text, const TextLook& look);
    void clip(const Rect& area);

    /// Code and count of numbers of each operation, in the order of drawing.
    [[nodiscard]] const std::vector<std::int32_t>& operations() const { return operations_; }
    [[nodiscard]] const std::vector<float>& numbers() const { return numbers_; }
    /// The texts in their order, each ended by a zero byte. UTF-8.
    [[nodiscard]] const std::string& texts() const { return texts_; }
    void each(const std::function<void(const Item&)>& visit) const;

private:
    void begin(Operation operation);
    void put(double number);
    void put(Point p);
    void put(const Colour& colour);
    std::vector<std::int32_t> operations_;
    std::vector<float> numbers_;
    std::string texts_;
};

} // namespace supercircle::picture
