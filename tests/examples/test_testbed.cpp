// The testbed without a window: panels drawn into pixels, scenes saved, restored, changed, pushed and recorded.

#ifdef SC_HAS_TESTBED

#include "examples/testbed/layers.h"
#include "examples/testbed/panel.h"
#include "examples/testbed/testbed.h"
#include "examples/testbed/testbed_scene.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <imgui.h>

using namespace supercircle;
using namespace supercircle::testbed;

namespace {

const std::string kScenes = std::string(SC_SOURCE_DIR) + "/scenes/";

TestbedScene openScene(const std::string& file) {
    Arguments a;
    a.scene = kScenes + file;
    TestbedScene scene(a);
    REQUIRE(scene.open().empty());
    return scene;
}

} // namespace

TEST_CASE("the panels' rasteriser covers every pixel of a rectangle once", "[testbed]") {
    PanelContext panels;
    graphics::CairoCanvas canvas(64, 64, 1.0);
    panels.begin(64, 64, {-1, -1}, false, 0.0);
    // Two half-transparent triangles: a pixel of their common edge drawn twice or never would show.
    ImGui::GetBackgroundDrawList()->AddRectFilled({10.0F, 20.0F}, {43.0F, 53.0F}, IM_COL32(255, 0, 0, 128));
    panels.end();
    panels.draw(canvas);
    const graphics::CairoCanvas::Pixels p = canvas.pixels();
    int inside = 0, wrong = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            std::uint32_t pixel = 0;
            std::memcpy(&pixel, p.data + static_cast<std::ptrdiff_t>(y) * p.stride + 4 * static_cast<std::ptrdiff_t>(x),
                        4);
            const bool in = x >= 10 && x < 43 && y >= 20 && y < 53;
            inside += in ? 1 : 0;
            wrong += (pixel & 0xffffffU) == (in ? 0xff7f7fU : 0xffffffU) ? 0 : 1; // 255 (1 - 128/255)
        }
    CHECK(inside == 33 * 33);
    CHECK(wrong == 0);
}

TEST_CASE("a click reaches a check box of a panel", "[testbed]") {
    PanelContext panels;
    graphics::CairoCanvas canvas(200, 100, 1.0);
    bool on = false;
    for (int frame = 0; frame < 6; ++frame) {
        panels.begin(200, 100, {25, 25}, frame == 2 || frame == 3, 0.0);
        ImGui::SetNextWindowPos({0.0F, 0.0F});
        ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoTitleBar);
        ImGui::SetCursorPos({15.0F, 15.0F});
        ImGui::Checkbox("on", &on);
        ImGui::End();
        panels.end();
        panels.draw(canvas);
        if (frame > 1)
            CHECK(panels.wantsMouse());
    }
    CHECK(on);
}

TEST_CASE("a restored scene continues identically", "[testbed]") {
    TestbedScene scene = openScene("two_shells.json");
    for (int i = 0; i < 20; ++i)
        scene.step();
    scene.save();
    for (int i = 0; i < 20; ++i)
        scene.step();
    const std::uint64_t first = scene.world().shells().hash();
    scene.restore();
    CHECK(scene.world().shells().time() == Approx(20.0 / 60.0));
    for (int i = 0; i < 20; ++i)
        scene.step();
    CHECK(scene.failure().empty());
    CHECK(scene.world().shells().hash() == first);
    CHECK(scene.curves().force.back() > 0.0);
}

TEST_CASE("a parameter counts from the next start on, and must be in its range", "[testbed]") {
    TestbedScene scene = openScene("two_shells.json");
    scene.set("mu", 0.1);
    CHECK(scene.world().scene().parameters[1].value == 0.35);
    REQUIRE(scene.open().empty());
    CHECK(scene.world().scene().parameters[1].value == 0.1);
    scene.set("mu", -1.0);
    CHECK(scene.open().find("mu") != std::string::npos);
}

TEST_CASE("things are pushed away from a point", "[testbed]") {
    TestbedScene scene = openScene("hello.json");
    for (int i = 0; i < 3; ++i)
        scene.step();
    const Shells& shells = scene.world().shells();
    const ShellHandle over = shells.find("over");
    const Point before = shells.state(over)->momentum;
    const Point at = shells.state(over)->centre;
    scene.pushAway({at.x + 1.0, at.y});
    CHECK(shells.state(over)->momentum.x < before.x);
    for (int i = 0; i < 60; ++i)
        scene.step();
    CHECK(scene.failure().empty());
}

TEST_CASE("layers are named, and unknown names are returned", "[testbed]") {
    Layers layers;
    CHECK(layers.set("energy,slip").empty());
    CHECK(layers.energy);
    CHECK_FALSE(layers.contacts);
    CHECK(layers.set("energy,colour") == "colour");
    CHECK(testbed::layers().size() == layers.all().size());
}

TEST_CASE("the motion is recorded as a table", "[testbed]") {
    TestbedScene scene = openScene("two_shells.json");
    Recorder recorder;
    const std::string film = std::string(SC_BINARY_DIR) + "/recorded.mp4";
    (void)recorder.start(film, 64, 64); // without ffmpeg it says that only the table is written
    REQUIRE(recorder.running());
    for (int i = 0; i < 5; ++i) {
        scene.step();
        recorder.motion(scene.world());
        recorder.picture(graphics::CairoCanvas(64, 64, 1.0));
    }
    recorder.stop();
    std::ifstream in(std::string(SC_BINARY_DIR) + "/recorded.csv");
    int lines = 0;
    for (std::string line; std::getline(in, line);)
        ++lines;
    CHECK(lines == 1 + 5 * 2); // two shells
}

#endif

TEST_CASE("an interrupted view ends after its step, with its picture", "[testbed]") {
    const std::string png = (std::filesystem::temp_directory_path() / "supercircle_interrupted.png").string();
    std::filesystem::remove(png);
    const std::atomic<bool> interrupt{true};
    Arguments a;
    a.scene = std::string(SC_SOURCE_DIR) + "/scenes/two_shells.json";
    a.headless = true;
    a.frames = 1000000;
    a.png = png;
    a.interrupt = &interrupt;
    CHECK(view(a) == 130);
    CHECK(std::filesystem::file_size(png) > 1000);
    std::filesystem::remove(png);
}
