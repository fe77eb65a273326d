#pragma once
// The picture of a level: camera, bodies, shells, the dragged point, title, status and hint. All games and the testbed
// share it. It becomes a draw list (docs/reference/picture.md), which windows and PNG files draw alike.

#include "examples/games/frame/game_world.h"
#include "plugin/graphics/picture/list_canvas.h"
#include "plugin/graphics/picture/world_picture.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supercircle::frame {

using graphics::Canvas;
using graphics::Colour;

namespace look {
inline constexpr Colour strip = Colour::hex(0x1d232d);
inline constexpr Colour rule = Colour::hex(0x3a4452);
inline constexpr Colour ink = Colour::hex(0xe9edf2);
inline constexpr Colour muted = Colour::hex(0x9aa5b3);
inline constexpr Colour driven = Colour::hex(0x3b5170), drivenEdge = Colour::hex(0x9dbbe2);
inline constexpr Colour loose = Colour::hex(0x5b4a33), looseEdge = Colour::hex(0xd0a868);
inline constexpr Colour good = Colour::hex(0x62d394), bad = Colour::hex(0xff8068), accent = Colour::hex(0x6fb4ff);
inline constexpr double top = 52.0;    ///< px, strip above
inline constexpr double bottom = 34.0; ///< px, strip below
} // namespace look

/// Without a colour that of the body's role.
struct Style {
    std::optional<Colour> fill{}, edge{};
};

/// The visible box of the world, with the zoom and shift of the player.
class Camera {
public:
    void fit(Point lower, Point upper) {
        lower_ = lower;
        upper_ = upper;
        home();
    }
    void home() {
        zoom_ = 1.0;
        shift_ = {};
    }
    void resize(double width, double height, double left = 0.0);
    /// Zooms; the point under the mouse stays.
    void zoom(double factor, graphics::Point at);
    void pan(double dx, double dy);
    [[nodiscard]] double scale() const; ///< px per metre
    [[nodiscard]] graphics::Point pixel(Point p) const;
    [[nodiscard]] Point world(graphics::Point p) const;

private:
    Point lower_{-8, -1}, upper_{8, 8}, shift_{};
    double zoom_ = 1.0, width_ = 1280.0, height_ = 720.0, left_ = 0.0;
};

/// A draw list with a camera.
class View {
public:
    View(picture::ListCanvas& canvas, const Camera& camera, double width, double height);
    [[nodiscard]] Canvas& canvas() const { return *canvas_; }
    [[nodiscard]] const Camera& camera() const { return *camera_; }
    [[nodiscard]] double width() const { return width_; }
    [[nodiscard]] double height() const { return height_; }
    [[nodiscard]] graphics::Point pixel(Point p) const { return camera_->pixel(p); }

    void background() const;
    void bodies(const GameWorld& world, double alpha, const std::function<Style(const b2Body&)>& style = {}) const;
    /// Shells in colours of their own, lighter where they store energy.
    void shells(const GameWorld& world, double alpha, const std::function<Colour(ShellHandle)>& colour = {}) const;
    void shells(const std::vector<picture::Shell>& shells) const { picture::addShells(canvas_->list(), seen_, shells); }
    /// Energies of snaps, with a flash.
    void snaps(GameWorld& world) const;
    void drag(const GameWorld& world) const;
    /// Shapes of a game, in world coordinates.
    void disc(Point centre, double radius, const Style& style) const;
    void line(Point a, Point b, const Colour& colour, double width, bool dashed = false) const;
    void area(Point lower, Point upper, const Colour& colour, const std::string& label) const;
    void label(Point at, const std::string& text, const Colour& colour, double size = 14.0) const;
    /// A shell that is not there yet.
    void ghost(const std::vector<Point>& line, const Colour& colour) const;
    /// Thinner shells are drawn as thick as this, m.
    [[nodiscard]] double thinnest() const { return 5.0 / camera_->scale(); }

private:
    picture::ListCanvas* canvas_;
    const Camera* camera_;
    double width_, height_;
    picture::View seen_;
};

/// One entry of the status line.
struct StatusEntry {
    std::string name, value;
    Colour colour = look::ink;
};

/// Title, status and hint around the picture.
void drawStrips(const View& view, const std::string& title, const std::vector<StatusEntry>& status,
                const std::string& hint, const std::string& corner = "");
/// A card in the middle, for the end of a game and for help.
void drawCard(const View& view, const std::string& title, const std::vector<std::string>& lines, const Colour& colour);
/// Keys and what they do, a card at the right.
void drawHelp(const View& view, const std::vector<std::pair<std::string, std::string>>& keys);
/// A bar chart of energies, at (x, y) px.
void drawEnergy(const View& view, double x, double y, const std::string& title,
                const std::vector<std::pair<std::string, double>>& joules, const std::vector<Colour>& colours);
/// "12.3", at most `digits` after the point.
[[nodiscard]] std::string number(double value, int digits);

} // namespace supercircle::frame
