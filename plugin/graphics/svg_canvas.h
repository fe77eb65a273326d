#pragma once

#include <string>

#include "plugin/graphics/canvas.h"

namespace supercircle::report {

/// Draws into SVG text.
class SvgCanvas final : public Canvas {
public:
    /// `id` must be unique in the page; `label` is what a screen reader says.
    SvgCanvas(double width, double height, std::string id, std::string label);

    void path(const std::vector<Point>& points, bool closed, const Paint& paint) override;
    void circle(Point centre, double radius, const Paint& paint) override;
    void text(Point at, std::string_view text, const TextStyle& style) override;
    void pushClip(const Rect& area) override;
    void popClip() override;

    /// Markup of the page's own (the player's markers).
    void raw(std::string_view markup) { body += markup; }
    /// The whole element; ends the drawing.
    [[nodiscard]] std::string finish();

private:
    void paintAttributes(const Paint& paint);
    std::string name;
    std::string body;
    int clips = 0;
};

/// `text` with the characters that mean something in HTML and SVG escaped.
[[nodiscard]] std::string escaped(std::string_view text);

/// Coordinate with at most `decimals` decimals, without trailing zeros.
void appendFixed(std::string& out, double value, int decimals = 2);

} // namespace supercircle::report
