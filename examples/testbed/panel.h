#pragma once
// Dear ImGui without a window system or a graphics card: fed with Input, drawn by a small rasteriser into the picture
// that Cairo made. One path for windows and PNG files, so that panels can be tested and shown without a display.

#include "plugin/graphics/cairo_canvas.h"

struct ImDrawData;

namespace supercircle::testbed {

class PanelContext {
public:
    PanelContext();
    ~PanelContext();
    PanelContext(const PanelContext&) = delete;
    PanelContext& operator=(const PanelContext&) = delete;
    /// Mouse in pixels; then call ImGui, then draw().
    void begin(double width, double height, report::Point mouse, bool button, double wheel);
    void draw(const report::CairoCanvas& picture);
    void skip(); ///< instead of draw() when nobody looks
    /// The mouse belongs to a panel.
    [[nodiscard]] bool wantsMouse() const;

private:
    unsigned char* glyphs_ = nullptr; ///< coverage, one byte a texel
    int glyphsWidth_ = 0, glyphsHeight_ = 0;
};

} // namespace supercircle::testbed
