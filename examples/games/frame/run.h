#pragma once
// Writes pictures into files; run() is declared in game.h.

#include "plugin/graphics/cairo_canvas.h"

#include <string>

namespace supercircle::frame {

/// Writes a picture; empty, or the error.
std::string writePng(const std::string& path, graphics::CairoCanvas& canvas);

} // namespace supercircle::frame
