#pragma once
// Draws a list of plugin/graphics/picture with OpenGL 3.3 into the current context.

#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/picture/draw_list.h"

#include <memory>
#include <string>

namespace supercircle::frame {

class GlPicture {
public:
    GlPicture();
    ~GlPicture();
    GlPicture(const GlPicture&) = delete;
    GlPicture& operator=(const GlPicture&) = delete;
    /// Compiles the shaders; empty, or the error. A context of OpenGL 3.3 is current, here and in all other calls.
    std::string open();
    /// Width and height of the frame buffer, px.
    void draw(const picture::DrawList& list, int width, int height);
    /// Pixels over the picture, transparent or not.
    void drawOver(const graphics::CairoCanvas& canvas, int width, int height);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::frame
