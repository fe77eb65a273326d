// A window shows what a PNG file has. Needs a display, so window.sh starts it.

#include "examples/games/frame/gl_shapes.h"
#include "examples/games/frame/window.h"
#include "plugin/graphics/cairo_picture.h"
#include "plugin/graphics/picture/world_picture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fstream>

using namespace supercircle;
using picture::Colour;
using Pixel = picture::Point;

namespace {

constexpr int kWidth = 320, kHeight = 240;

/// Every operation: shells of both widths, bodies, a concave polygon, a turned text, a clip.
picture::DrawList everything() {
    picture::DrawList list;
    picture::View view;
    view.width = kWidth;
    view.height = kHeight;
    view.pixelsPerMetre = 1000.0;
    picture::Content content;
    for (const double radius : {0.06, 0.09}) {
        picture::Shell shell;
        shell.thickness = radius < 0.07 ? 0.008 : 0.001;
        for (int i = 0; i <= 40; ++i) {
            const double a = 0.11 * i;
            shell.line.push_back({radius * std::cos(a), radius * std::sin(a)});
            shell.energy.push_back(i / 40.0);
        }
        content.shells.push_back(shell);
    }
    content.bodies.push_back(
        {.points = {{-0.14, -0.11}, {0.13, -0.1}, {0.13, -0.07}, {-0.14, -0.08}}, .role = picture::Role::Driven});
    content.bodies.push_back({.points = {{0.12, 0.08}}, .radius = 0.02, .angle = 1.0, .role = picture::Role::Loose});
    content.contacts.push_back({{0.0, -0.075}, {0.0, 1.0}});
    content.holds.push_back({0.0, 0.09});
    content.snaps.push_back({{-0.1, 0.06}, 0.0023, 0.2, true});
    picture::addGround(list, view);
    picture::addWorld(list, view, content);
    list.polygon(std::vector<Pixel>{{20, 20}, {60, 20}, {60, 60}, {40, 35}, {20, 60}}, Colour::hex(0x44aa77, 0.5));
    list.text({300, 200}, "turned", {14.0, Colour::hex(0xffffff), picture::Anchor::Start, false, -90.0});
    list.clip({200, 10, 40, 20});
    list.disc({220, 30}, 18, Colour::hex(0xff8800));
    list.clip({0, 0, kWidth, kHeight});
    return list;
}

} // namespace

TEST_CASE("a window shows what a PNG file has, but for the smoothing of edges and letters", "[.window]") {
    frame::Window window;
    REQUIRE(window.open(kWidth, kHeight, "picture") == "");
    REQUIRE(window.width() == kWidth);
    REQUIRE(window.accelerated());
    const picture::DrawList list = everything();
    graphics::CairoCanvas over(kWidth, kHeight, 1.0, graphics::CairoCanvas::Ground::Transparent);
    over.rectangle({10, 200, 30, 20}, {.fill = Colour::hex(0x3366cc, 0.5)});
    window.show(list, &over);
    const std::vector<std::uint32_t> shown = window.pixels(list, &over);
    graphics::CairoCanvas canvas(kWidth, kHeight, 1.0);
    graphics::draw(canvas, list);
    graphics::drawOver(canvas, over);
    const graphics::CairoCanvas::Pixels p = canvas.pixels();
    REQUIRE(shown.size() == static_cast<std::size_t>(kWidth * kHeight));
    double sum = 0.0;
    int far = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            std::uint32_t drawn = 0;
            std::memcpy(&drawn, p.data + static_cast<std::ptrdiff_t>(y) * p.stride + 4 * x, 4);
            int most = 0;
            for (int c = 0; c < 24; c += 8)
                most = std::max(
                    most, std::abs(static_cast<int>(drawn >> c & 255U) -
                                   static_cast<int>(shown[static_cast<std::size_t>(y * kWidth + x)] >> c & 255U)));
            sum += most;
            far += most > 48 ? 1 : 0;
        }
    INFO("mean difference " << sum / (kWidth * kHeight) << ", far " << far);
    // Edges are one pixel wide and letters may lie half a pixel aside: a wrong colour, width or place of one band
    // changes hundreds of pixels.
    CHECK(sum / (kWidth * kHeight) < 1.5);
    CHECK(far < 150);
    if (const char* name = std::getenv("SUPERCIRCLE_WINDOW_PICTURE")) { // to look at: both, as raw pixels
        std::ofstream out(name, std::ios::binary);
        out.write(reinterpret_cast<const char*>(shown.data()), static_cast<std::streamsize>(4 * shown.size()));
        for (int y = 0; y < kHeight; ++y)
            out.write(reinterpret_cast<const char*>(p.data + static_cast<std::ptrdiff_t>(y) * p.stride), 4 * kWidth);
    }
}

TEST_CASE("polygons for OpenGL cover their area once", "[frame]") {
    picture::DrawList list;
    const std::vector<Pixel> concave{{0, 0}, {100, 0}, {100, 100}, {50, 40}, {0, 100}};
    const double area = 100.0 * 100.0 - 0.5 * 100.0 * 60.0;
    list.polygon(concave, Colour::hex(0xffffff));
    list.polygon(std::vector<Pixel>(concave.rbegin(), concave.rend()), Colour::hex(0xffffff));
    const frame::GlShapes shapes = frame::shapesOf(list);
    REQUIRE(shapes.batches.size() == 1);
    double full = 0.0, seam = 0.0;
    for (std::size_t i = 0; i < shapes.corners.size(); i += 3) {
        const auto at = [&](std::size_t k) { return shapes.corners[i + k]; };
        const double twice = (at(1).at[0] - at(0).at[0]) * (at(2).at[1] - at(0).at[1]) -
                             (at(1).at[1] - at(0).at[1]) * (at(2).at[0] - at(0).at[0]);
        const bool inner = at(0).colour[3] + at(1).colour[3] + at(2).colour[3] == 3 * 255;
        (inner ? full : seam) += 0.5 * std::abs(twice);
    }
    const double edges = 100.0 + 2.0 * 100.0 + 2.0 * std::hypot(50.0, 60.0);
    // Two polygons; half a pixel less along the edges, and a seam of a pixel. The ten corners: up to four square
    // pixels each, where acute ones are cut off.
    CHECK(full == Approx(2.0 * (area - 0.5 * edges)).margin(40.0));
    CHECK(seam == Approx(2.0 * edges).margin(40.0));
}

TEST_CASE("pieces of a band are cut at smooth joints and overlap at sharp ones", "[frame]") {
    picture::DrawList list;
    list.line(std::vector<Pixel>{{0, 0}, {10, 0}, {20, 5}, {15, 5}}, false, 2.0, Colour::hex(0xffffff, 0.5));
    const frame::GlShapes shapes = frame::shapesOf(list);
    REQUIRE(shapes.pieces.size() == 3);
    CHECK(shapes.pieces[0].cutA == std::array<float, 2>{0, 0}); // the end is round
    CHECK(shapes.pieces[0].cutB == shapes.pieces[1].cutA);
    CHECK(shapes.pieces[0].cutB[0] > 0.0F);
    CHECK(shapes.pieces[1].cutB == std::array<float, 2>{0, 0});
    CHECK(shapes.pieces[0].colour[3] == 128);
}
