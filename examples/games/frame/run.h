#pragma once
// Pictures into files; the program itself is declared in game.h.

#include "plugin/graphics/cairo_canvas.h"

#include <string>

namespace supercircle::frame {

/// Writes a picture; empty, or why not.
std::string writePng(const std::string& path, report::CairoCanvas& canvas);

} // namespace supercircle::frame
