#pragma once
// Draws a list of plugin/graphics/picture with Cairo: PNG files, films, and windows without OpenGL 3.3.

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/picture/draw_list.h"

namespace supercircle::graphics {

/// One pixel of the list is one unit of the canvas.
void draw(CairoCanvas& canvas, const picture::DrawList& list);

/// The pixels of another canvas over it, which may be transparent.
void drawOver(CairoCanvas& canvas, const CairoCanvas& over);

/// Coverage of a text by pixels, for back ends with textures: rows from the top, 0 to 255.
struct TextCoverage {
    int width = 0, height = 0;    ///< px
    double left = 0.0, top = 0.0; ///< of the box from the text's start on the base line, px
    double advance = 0.0;         ///< width of the text for its anchor, px
    std::vector<unsigned char> alpha{};
};
[[nodiscard]] TextCoverage textCoverage(std::string_view text, double size, bool bold);

} // namespace supercircle::graphics
