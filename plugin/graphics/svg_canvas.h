#pragma once

#include <string>

#include "plugin/graphics/canvas.h"

namespace supercircle::graphics {

/// Draws into SVG text.
class SvgCanvas final : public Canvas {
public:
    /// `id` must be unique in the page; `label` is the text for screen readers.
    SvgCanvas(double width, double height, std::string id, std::string label);

    void path(const std::vector<Point>& points, bool closed, const Paint& paint) override;
    void circle(Point centre, double radius, const Paint& paint) override;
    void text(Point at, std::string_view text, const TextStyle& style) override;
    void pushClip(const Rect& area) override;
    void popClip() override;

    /// Adds markup (the player's markers).
    void raw(std::string_view markup) { body_ += markup; }
    /// The whole element; ends the drawing.
    [[nodiscard]] std::string finish();

private:
    void paintAttributes(const Paint& paint);
    std::string name_;
    std::string body_;
    int clips_ = 0;
};

/// `text` with the special characters of HTML and SVG escaped.
[[nodiscard]] std::string escaped(std::string_view text);

/// Coordinate with at most `decimals` decimals, without trailing zeros.
void appendFixed(std::string& out, double value, int decimals = 2);

} // namespace supercircle::graphics
