#pragma once
// Dear ImGui without window system and graphics card: a small rasteriser draws it into pixels of Cairo. It is the same
// for windows and PNG files, so that panels can be tested without a display.

#include "plugin/graphics/cairo_canvas.h"

struct ImDrawData;

namespace supercircle::testbed {

class PanelContext {
public:
    PanelContext();
    ~PanelContext();
    PanelContext(const PanelContext&) = delete;
    PanelContext& operator=(const PanelContext&) = delete;
    /// Mouse in pixels; then call ImGui, then end() and draw(), or skip().
    void begin(double width, double height, graphics::Point mouse, bool button, double wheel);
    void end();
    /// Draws over what is there, on a transparent ground, too.
    void draw(const graphics::CairoCanvas& picture);
    void skip(); ///< instead of end() when the picture is not shown
    /// The mouse belongs to a panel.
    [[nodiscard]] bool wantsMouse() const;

private:
    unsigned char* glyphs_ = nullptr; ///< coverage, one byte a texel
    int glyphsWidth_ = 0, glyphsHeight_ = 0;
};

} // namespace supercircle::testbed
