#pragma once
// Draws a list of plugin/graphics/picture with Cairo: PNG files, films, and windows without OpenGL 3.3.

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/picture/draw_list.h"

namespace supercircle::graphics {

/// One pixel of the list is one unit of the canvas.
void draw(CairoCanvas& canvas, const picture::DrawList& list);

} // namespace supercircle::graphics
