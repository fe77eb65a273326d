#pragma once
// Pictures into files; the program itself is declared in game.h.

#include "examples/frame/view.h"

#include <functional>
#include <string>

namespace supercircle::frame {

/// Draws a picture and writes it; empty, or why not.
std::string writePng(const std::string& path, int width, int height,
                     const std::function<void(Canvas&, double, double)>& draw);

} // namespace supercircle::frame
