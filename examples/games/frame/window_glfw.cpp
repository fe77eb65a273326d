// OpenGL 3.3 draws the picture. Where there is none, Cairo draws it as for PNG files, and OpenGL 2.0 shows it as one
// texture, whose size is no power of two.

#include "examples/games/frame/window.h"

#include "examples/games/frame/gl_picture.h"
#include "plugin/graphics/cairo_picture.h"

#define GLFW_INCLUDE_GLEXT
#include <GLFW/glfw3.h>

#include <algorithm>

namespace supercircle::frame {

namespace {

constexpr int kLeastWindow = 64; ///< px; a minimised window has 0, of which no canvas can be made

std::string keyName(int key) {
    if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z)
        return std::string(1, static_cast<char>('a' + key - GLFW_KEY_A));
    if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9)
        return std::string(1, static_cast<char>('0' + key - GLFW_KEY_0));
    switch (key) {
    case GLFW_KEY_LEFT:
        return "left";
    case GLFW_KEY_RIGHT:
        return "right";
    case GLFW_KEY_UP:
        return "up";
    case GLFW_KEY_DOWN:
        return "down";
    case GLFW_KEY_SPACE:
        return "space";
    case GLFW_KEY_ENTER:
    case GLFW_KEY_KP_ENTER:
        return "enter";
    case GLFW_KEY_ESCAPE:
        return "escape";
    case GLFW_KEY_HOME:
        return "home";
    case GLFW_KEY_PERIOD:
        return ".";
    default:
        return "";
    }
}

} // namespace

struct Window::Impl {
    GLFWwindow* window = nullptr;
    bool started = false;
    Pointer pointer;
    GLuint texture = 0;                 ///< of what Cairo draws
    std::unique_ptr<GlPicture> picture; ///< null: Cairo draws
    Input* input = nullptr;             ///< while polling

    static Impl& of(GLFWwindow* w) { return *static_cast<Impl*>(glfwGetWindowUserPointer(w)); }
    void listen();
    void draw(const picture::DrawList& list, const graphics::CairoCanvas* over, int width, int height);
    void pixel(double x, double y, graphics::Point& out) const;
};

/// Place `out` in pixels of the picture of a cursor at x, y, which GLFW gives in screen coordinates.
void Window::Impl::pixel(double x, double y, graphics::Point& out) const {
    int ww = 1, wh = 1, fw = 1, fh = 1;
    glfwGetWindowSize(window, &ww, &wh);
    glfwGetFramebufferSize(window, &fw, &fh);
    out = {x * fw / std::max(ww, 1), y * fh / std::max(wh, 1)};
}

void Window::Impl::listen() {
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
        const std::string name = keyName(key);
        Impl& s = of(w);
        if (s.input == nullptr || name.empty() || action == GLFW_REPEAT)
            return;
        action == GLFW_PRESS ? s.input->keyDown(name) : s.input->keyUp(name);
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int) {
        Impl& s = of(w);
        const bool down = action == GLFW_PRESS;
        if (button == GLFW_MOUSE_BUTTON_RIGHT || button == GLFW_MOUSE_BUTTON_MIDDLE)
            s.pointer.right = down;
        if (button != GLFW_MOUSE_BUTTON_LEFT)
            return;
        s.pointer.left = down;
        if (s.input != nullptr)
            down ? s.input->buttonDown() : s.input->buttonUp();
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        Impl& s = of(w);
        const graphics::Point old = s.pointer.at;
        s.pixel(x, y, s.pointer.at);
        if (s.pointer.right) {
            s.pointer.dragX += s.pointer.at.x - old.x;
            s.pointer.dragY += s.pointer.at.y - old.y;
        }
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double, double dy) { of(w).pointer.wheel += dy; });
}

Window::Window() : impl_(std::make_unique<Impl>()) {}

Window::~Window() {
    impl_->picture.reset();
    if (impl_->window != nullptr)
        glfwDestroyWindow(impl_->window);
    if (impl_->started)
        glfwTerminate();
}

std::string Window::open(int width, int height, const std::string& title) {
    const auto why = [] {
        const char* text = nullptr;
        glfwGetError(&text);
        return std::string("no window can be opened: ") + (text != nullptr ? text : "unknown reason") +
               "; --headless needs none";
    };
    if (glfwInit() == GLFW_FALSE)
        return why();
    impl_->started = true;
    const auto create = [&](bool modern) {
        glfwDefaultWindowHints();
        if (modern) {
            glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
            glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
            glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        }
        if (impl_->window != nullptr) // a window keeps the kind of its context
            glfwDestroyWindow(impl_->window);
        impl_->window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
        if (impl_->window == nullptr)
            return false;
        glfwMakeContextCurrent(impl_->window);
        glfwSwapInterval(1);
        return true;
    };
    if (create(true)) {
        impl_->picture = std::make_unique<GlPicture>();
        if (!impl_->picture->open().empty())
            impl_->picture.reset();
    }
    if (!impl_->picture) {
        if (!create(false))
            return why();
        glGenTextures(1, &impl_->texture);
        glBindTexture(GL_TEXTURE_2D, impl_->texture);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glEnable(GL_TEXTURE_2D);
    }
    impl_->listen();
    return {};
}

bool Window::poll(Input& input, const std::function<Point(graphics::Point)>& world) {
    impl_->pointer.wheel = impl_->pointer.dragX = impl_->pointer.dragY = 0.0;
    impl_->input = &input;
    glfwPollEvents();
    impl_->input = nullptr;
    input.moveMouse(world(impl_->pointer.at));
    return glfwWindowShouldClose(impl_->window) == GLFW_FALSE;
}

const Pointer& Window::pointer() const {
    return impl_->pointer;
}

int Window::width() const {
    int w = 0, h = 0;
    glfwGetFramebufferSize(impl_->window, &w, &h);
    return std::max(w, kLeastWindow);
}

int Window::height() const {
    int w = 0, h = 0;
    glfwGetFramebufferSize(impl_->window, &w, &h);
    return std::max(h, kLeastWindow);
}

double Window::seconds() const {
    return glfwGetTime();
}

bool Window::accelerated() const {
    return impl_->picture != nullptr;
}

void Window::Impl::draw(const picture::DrawList& list, const graphics::CairoCanvas* over, int width, int height) {
    if (picture) {
        picture->draw(list, width, height);
        if (over != nullptr)
            picture->drawOver(*over, width, height);
        return;
    }
    graphics::CairoCanvas canvas(width, height, 1.0);
    graphics::draw(canvas, list);
    if (over != nullptr)
        graphics::drawOver(canvas, *over);
    const graphics::CairoCanvas::Pixels p = canvas.pixels();
    glViewport(0, 0, width, height);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, p.stride / 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB, p.width, p.height, 0, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, p.data);
    glBegin(GL_QUADS);
    const float corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (const auto& c : corners) {
        glTexCoord2f(c[0], c[1]);
        glVertex2f(2.0F * c[0] - 1.0F, 1.0F - 2.0F * c[1]);
    }
    glEnd();
}

void Window::show(const picture::DrawList& list, const graphics::CairoCanvas* over) {
    impl_->draw(list, over, width(), height());
    glfwSwapBuffers(impl_->window);
}

std::vector<std::uint32_t> Window::pixels(const picture::DrawList& list, const graphics::CairoCanvas* over) {
    const auto w = static_cast<std::size_t>(width()), h = static_cast<std::size_t>(height());
    impl_->draw(list, over, width(), height());
    std::vector<std::uint32_t> upwards(w * h), out;
    glReadPixels(0, 0, width(), height(), GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, upwards.data());
    for (std::size_t y = h; y-- > 0;) // rows of OpenGL begin at the bottom
        out.insert(out.end(), upwards.begin() + static_cast<std::ptrdiff_t>(y * w),
                   upwards.begin() + static_cast<std::ptrdiff_t>((y + 1) * w));
    return out;
}

} // namespace supercircle::frame
