#pragma once
// Writes pictures into files; run() is declared in game.h.

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/picture/draw_list.h"

#include <string>
#include <vector>

namespace supercircle::frame {

/// Writes a picture; empty, or the error.
std::string writePng(const std::string& path, graphics::CairoCanvas& canvas);
std::string writePng(const std::string& path, const picture::DrawList& list, int width, int height);
/// Writes samples; empty, or the error.
std::string writeWav(const std::string& path, const std::vector<float>& samples);

} // namespace supercircle::frame
