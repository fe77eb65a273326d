#pragma once
// A window that shows draw lists and collects input. Without GLFW open() fails with a message.

#include "examples/games/frame/input.h"
#include "plugin/graphics/cairo_canvas.h"
#include "plugin/graphics/picture/draw_list.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace supercircle::frame {

/// The mouse in pixels of the picture, in addition to Input.
struct Pointer {
    graphics::Point at{};
    double wheel = 0.0;               ///< notches since the last poll
    bool left = false, right = false; ///< buttons down
    double dragX = 0.0, dragY = 0.0;  ///< px, with the right button since the last poll
};

class Window {
public:
    Window();
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;
    /// Empty, or the error.
    std::string open(int width, int height, const std::string& title);
    /// Collects input; `world` turns pixels into metres. False when the window was closed.
    bool poll(Input& input, const std::function<Point(graphics::Point)>& world);
    [[nodiscard]] const Pointer& pointer() const;
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;
    [[nodiscard]] double seconds() const; ///< of a clock
    /// `over`: what is drawn over it, of the same size and transparent elsewhere; null: nothing.
    void show(const picture::DrawList& list, const graphics::CairoCanvas* over = nullptr);
    /// What show() would show, as CairoCanvas::pixels() has it, row by row without gaps; for tests.
    [[nodiscard]] std::vector<std::uint32_t> pixels(const picture::DrawList& list, const graphics::CairoCanvas* over);
    [[nodiscard]] bool accelerated() const; ///< by OpenGL 3.3; else Cairo draws

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace supercircle::frame
