// Replaces window_glfw.cpp in builds without GLFW.

#include "examples/games/frame/window.h"

namespace supercircle::frame {

struct Window::Impl {
    Pointer pointer;
};

Window::Window() : impl_(std::make_unique<Impl>()) {}
Window::~Window() = default;
std::string Window::open(int, int, const std::string&) {
    return "this build has no windows (GLFW was not found): use --headless, or install libglfw3-dev and build again";
}
bool Window::poll(Input&, const std::function<Point(graphics::Point)>&) {
    return false;
}
const Pointer& Window::pointer() const {
    return impl_->pointer;
}
int Window::width() const {
    return 1280;
}
int Window::height() const {
    return 720;
}
double Window::seconds() const {
    return 0.0;
}
void Window::show(const picture::DrawList&, const graphics::CairoCanvas*) {}
std::vector<std::uint32_t> Window::pixels(const picture::DrawList&, const graphics::CairoCanvas*) {
    return {};
}
bool Window::accelerated() const {
    return false;
}

} // namespace supercircle::frame
