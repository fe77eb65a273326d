// The framework of the games: inputs from scripts, camera, dragging, pictures between two steps, felt acceleration.

#include "examples/games/frame/felt_acceleration.h"
#include "examples/games/frame/game_world.h"
#include "examples/games/frame/input.h"
#include "examples/games/frame/view.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

using namespace supercircle;
using namespace supercircle::frame;
using Catch::Matchers::Contains;

namespace {

const std::string kHello = std::string(SC_SOURCE_DIR) + "/scenes/hello.json";

Script script(const std::string& text, std::string& error) {
    const std::string path = std::string(SC_BINARY_DIR) + "/frame_script.json";
    std::ofstream(path) << text;
    return Script::load(path, error);
}

} // namespace

TEST_CASE("a script says what is wrong with it, and where", "[frame]") {
    std::string error;
    script("[ { \"t\": 1, \"kye\": \"a\" },\n  { \"t\": -1, \"key\": \"a\" },\n  { \"t\": 1, \"key\": \"a\", \"down\": "
           "\"b\" } ]",
           error);
    CHECK_THAT(error,
               Contains("frame_script.json:1:13: /0/kye: unknown key \"kye\"") && Contains("did you mean \"key\"?"));
    CHECK_THAT(error, Contains(":2:10: /1/t: -1 is out of range"));
    CHECK_THAT(error, Contains(":3:3: /2: 2 inputs in one line of the script"));
    error.clear();
    script("[ { \"t\": 1, ]", error);
    CHECK_THAT(error, Contains("frame_script.json:1:"));
}

TEST_CASE("a script presses keys for one step and glides the mouse", "[frame]") {
    std::string error;
    Script s =
        script("[ {\"t\": 0, \"key\": \"a\"}, {\"t\": 0, \"down\": \"up\"}, {\"t\": 0.05, \"up\": \"up\"},"
               "{\"t\": 0, \"mouse\": {\"x\": 6, \"y\": 3}, \"over\": 0.1}, {\"t\": 0.1, \"button\": \"click\"} ]",
               error);
    REQUIRE(error.empty());
    Input input;
    for (std::uint64_t frame = 0; frame < 10; ++frame) {
        s.play(frame, input);
        INFO(frame);
        CHECK(input.pressed("a") == (frame == 0));
        CHECK(input.held("a") == (frame == 0));
        CHECK(input.held("up") == (frame < 3)); // 0.05 s are three steps
        CHECK(input.mouse().x == Approx(std::min(1.0, static_cast<double>(frame) / 6.0) * 6.0));
        CHECK(input.clicked() == (frame == 6));
        CHECK(input.buttonHeld() == (frame == 6));
        CHECK(input.released() == (frame == 7));
        input.forget();
    }
    CHECK(s.done());
}

TEST_CASE("the camera turns pixels into places and back, and zooms about the mouse", "[frame]") {
    Camera camera;
    camera.fit({-3, 1}, {5, 4});
    camera.resize(1280, 720, 200);
    const auto same = [&](Point p) {
        const Point back = camera.world(camera.pixel(p));
        return std::hypot(back.x - p.x, back.y - p.y) < 1e-12; // rounding of numbers of size 1000
    };
    CHECK(same({-3, 1}));
    const graphics::Point mouse{700, 300};
    const Point before = camera.world(mouse);
    camera.zoom(2.5, mouse);
    camera.pan(13, -40);
    camera.pan(-13, 40);
    const Point after = camera.world(mouse);
    CHECK(std::hypot(after.x - before.x, after.y - before.y) < 1e-12);
    CHECK(same({7, 7}));
    camera.home();
    CHECK(camera.pixel({-3, 1}).x >= 200.0); // what was asked for is in the picture, right of the panel
    CHECK(camera.pixel({5, 4}).y >= look::top);
}

TEST_CASE("the mouse drags shells and bodies", "[frame]") {
    const auto world = GameWorld::load(kHello);
    REQUIRE(world);
    GameWorld& s = **world;
    CHECK_FALSE(s.startDrag({5.5, 4.5}, 0.1)); // nothing there
    const ShellHandle shell = s.shells().find("over");
    const Point drag = s.shells().section(shell, 0.5)->position;
    REQUIRE(s.startDrag(drag, 0.1));
    const Point target{drag.x, drag.y + 1.0};
    s.moveMouse(target);
    for (int i = 0; i < 240; ++i)
        REQUIRE(s.step().failure.empty());
    // It hangs on a spring of 5 Hz: below the target by g / (2 pi f)^2 = 9.9 mm, and still sways a little.
    CHECK(std::abs(s.dragPoint().x - target.x) < 0.02);
    CHECK(s.dragPoint().y == Approx(target.y - 9.81 / std::pow(10.0 * M_PI, 2)).margin(0.02));
    CHECK(s.draggedShell() == shell);
    s.releaseMouse();
    CHECK_FALSE(s.dragging());
    CHECK(s.draggedShell().null());
    REQUIRE(s.startDrag(s.position(*s.body("crate")), 0.0));
    CHECK(s.draggedBody() == s.body("crate"));
    CHECK(s.dragCount() == 2);
}

TEST_CASE("pictures between two steps lie between them", "[frame]") {
    const auto world = GameWorld::load(kHello);
    REQUIRE(world);
    GameWorld& s = **world;
    const ShellHandle shell = s.shells().find("rolling");
    for (int i = 0; i < 10; ++i)
        s.step();
    const auto a = s.line(shell, 0.0), b = s.line(shell, 1.0), half = s.line(shell, 0.5);
    REQUIRE(a.size() == half.size());
    CHECK(std::hypot(a[5].x - b[5].x, a[5].y - b[5].y) > 0.01); // it moves with 1.5 m/s
    for (std::size_t i = 0; i < half.size(); ++i)
        CHECK(half[i].y == Approx(0.5 * (a[i].y + b[i].y)).epsilon(1e-12));
}

TEST_CASE("felt acceleration: none in free fall, 1 g at rest, v / t when stopped", "[frame]") {
    FeltAcceleration feel;
    feel.reset({0.0, 0.0});
    double v = 0.0;
    for (int i = 0; i < 20; ++i)
        feel.step({0.0, v -= FeltAcceleration::kG * kStep});
    CHECK(feel.hardest() < 1e-12);
    for (int i = 0; i < 20; ++i)
        feel.step({0.0, v});
    CHECK(feel.hardest() == Approx(1.0));
    feel.step({0.0, 0.0}); // stopped within one step: half of it counts, the mean of two
    CHECK(feel.hardest() == Approx(1.0 - 0.5 * v / kStep / FeltAcceleration::kG));
}
